#include "server/planning/planning_service.h"

#include "server/entry/operation_answer.h"
#include "server/entry/unary.h"
#include "server/planning/deficit_measuring.h"
#include "server/planning/delivery_calls.h"
#include "server/planning/face_arrangement.h"
#include "server/planning/proposal_calls.h"
#include "server/planning/target_making.h"

namespace lipofill::server {

PlanningService::Reactor* PlanningService::MakeTarget(Context* context, const v1::MakeTargetRequest* request,
                                                      v1::Operation* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto operation = start_target(backend_, call_of(context).principal, *request);
    if (operation.ok()) *response = to_operation(backend_, *operation);
    return operation.status();
  });
}

PlanningService::Reactor* PlanningService::ProposePlan(Context* context, const v1::ProposePlanRequest* request,
                                                       v1::Operation* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto operation = start_proposal(backend_, call_of(context).principal, *request);
    if (operation.ok()) *response = to_operation(backend_, *operation);
    return operation.status();
  });
}

PlanningService::Reactor* PlanningService::MeasureDeficit(Context* context, const v1::MeasureDeficitRequest* request,
                                                          v1::Deficit* response) {
  return answer_later(context, request, backend_, [this, context, request, response]() -> absl::Status {
    auto deficit = measure_deficit_of(backend_, *request, caller_has_left(context));
    if (deficit.ok()) *response = *std::move(deficit);
    return deficit.status();
  });
}

PlanningService::Reactor* PlanningService::PlanDelivery(Context* context, const v1::PlanDeliveryRequest* request,
                                                        v1::Delivery* response) {
  return answer_later(context, request, backend_, [this, context, request, response]() -> absl::Status {
    auto delivery = plan_delivery(backend_, *request, caller_has_left(context));
    if (delivery.ok()) *response = *std::move(delivery);
    return delivery.status();
  });
}

PlanningService::Reactor* PlanningService::ArrangeFace(Context* context, const v1::ArrangeFaceRequest* request,
                                                       v1::FaceArrangement* response) {
  return answer_later(context, request, backend_, [this, context, request, response]() -> absl::Status {
    auto arrangement = arrange_face(backend_, *request, caller_has_left(context));
    if (arrangement.ok()) *response = *std::move(arrangement);
    return arrangement.status();
  });
}

}  // namespace lipofill::server
