#pragma once

#include "lipofill/v1/plan_service.grpc.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// Plans that are kept. See proto/lipofill/v1/plan_service.proto for what each call does.
class PlanService : public v1::PlanService::CallbackService {
 public:
  explicit PlanService(Backend& backend) : backend_(backend) {}

  using Context = grpc::CallbackServerContext;
  using Reactor = grpc::ServerUnaryReactor;

  Reactor* CreatePlan(Context* context, const v1::CreatePlanRequest* request, v1::SavedPlan* response) override;
  Reactor* GetPlan(Context* context, const v1::GetPlanRequest* request, v1::SavedPlan* response) override;
  Reactor* ListPlans(Context* context, const v1::ListPlansRequest* request, v1::ListPlansResponse* response) override;
  Reactor* UpdatePlan(Context* context, const v1::UpdatePlanRequest* request, v1::SavedPlan* response) override;
  Reactor* DeletePlan(Context* context, const v1::DeletePlanRequest* request,
                      google::protobuf::Empty* response) override;
  Reactor* AddPlanRun(Context* context, const v1::AddPlanRunRequest* request, v1::SavedPlan* response) override;
  Reactor* ListPlanRevisions(Context* context, const v1::ListPlanRevisionsRequest* request,
                             v1::ListPlanRevisionsResponse* response) override;
  Reactor* GetPlanRevision(Context* context, const v1::GetPlanRevisionRequest* request,
                           v1::SavedPlan* response) override;

 private:
  Backend& backend_;
};

}  // namespace lipofill::server
