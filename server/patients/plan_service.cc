#include "server/patients/plan_service.h"

#include "server/entry/unary.h"
#include "server/patients/plan_calls.h"
#include "server/wire/field_mask.h"

namespace lipofill::server {
namespace {

/// Hands what a call made to its response.
template <typename Response>
absl::Status respond(absl::StatusOr<Response> made, Response& response) {
  if (made.ok()) response = *std::move(made);
  return made.status();
}

}  // namespace

PlanService::Reactor* PlanService::CreatePlan(Context* context, const v1::CreatePlanRequest* request,
                                              v1::SavedPlan* response) {
  return answer(context, request,
                [&] { return respond(create_plan(backend_, call_of(context).principal, *request), *response); });
}

PlanService::Reactor* PlanService::GetPlan(Context* context, const v1::GetPlanRequest* request,
                                           v1::SavedPlan* response) {
  const auto read = [&] { return respond(get_plan(backend_, request->name()), *response); };
  return answer(context, request, [&] { return read_masked(*request, *response, read); });
}

PlanService::Reactor* PlanService::ListPlans(Context* context, const v1::ListPlansRequest* request,
                                             v1::ListPlansResponse* response) {
  return answer(context, request,
                [&] { return respond(list_plans(backend_, call_of(context).principal, *request), *response); });
}

PlanService::Reactor* PlanService::UpdatePlan(Context* context, const v1::UpdatePlanRequest* request,
                                              v1::SavedPlan* response) {
  return answer(context, request, [&] { return respond(update_plan(backend_, *request), *response); });
}

PlanService::Reactor* PlanService::DeletePlan(Context* context, const v1::DeletePlanRequest* request,
                                              google::protobuf::Empty*) {
  return answer(context, request, [&] { return delete_plan(backend_, *request); });
}

PlanService::Reactor* PlanService::AddPlanRun(Context* context, const v1::AddPlanRunRequest* request,
                                              v1::SavedPlan* response) {
  return answer(context, request, [&] { return respond(add_plan_run(backend_, *request), *response); });
}

PlanService::Reactor* PlanService::ListPlanRevisions(Context* context, const v1::ListPlanRevisionsRequest* request,
                                                     v1::ListPlanRevisionsResponse* response) {
  return answer(context, request, [&] { return respond(list_plan_revisions(backend_, *request), *response); });
}

PlanService::Reactor* PlanService::GetPlanRevision(Context* context, const v1::GetPlanRevisionRequest* request,
                                                   v1::SavedPlan* response) {
  return answer(context, request, [&] { return respond(get_plan_revision(backend_, *request), *response); });
}

}  // namespace lipofill::server
