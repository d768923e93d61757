#pragma once

#include "lipofill/v1/planning_service.grpc.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// From a picture to a plan. See proto/lipofill/v1/planning_service.proto for what each call does.
class PlanningService : public v1::PlanningService::CallbackService {
 public:
  explicit PlanningService(Backend& backend) : backend_(backend) {}

  using Context = grpc::CallbackServerContext;
  using Reactor = grpc::ServerUnaryReactor;

  Reactor* MakeTarget(Context* context, const v1::MakeTargetRequest* request, v1::Operation* response) override;
  Reactor* ProposePlan(Context* context, const v1::ProposePlanRequest* request, v1::Operation* response) override;
  Reactor* MeasureDeficit(Context* context, const v1::MeasureDeficitRequest* request, v1::Deficit* response) override;
  Reactor* PlanDelivery(Context* context, const v1::PlanDeliveryRequest* request, v1::Delivery* response) override;
  Reactor* ArrangeFace(Context* context, const v1::ArrangeFaceRequest* request, v1::FaceArrangement* response) override;

 private:
  Backend& backend_;
};

}  // namespace lipofill::server
