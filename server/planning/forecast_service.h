#pragma once

#include "lipofill/v1/forecast_service.grpc.pb.h"
#include "server/backend/backend.h"

namespace lipofill::server {

/// The service tells what is known of a plan's result. See proto/lipofill/v1/forecast_service.proto
/// for what each call does.
class ForecastService : public v1::ForecastService::CallbackService {
 public:
  explicit ForecastService(Backend& backend) : backend_(backend) {}

  using Context = grpc::CallbackServerContext;
  using Reactor = grpc::ServerUnaryReactor;

  Reactor* MakeForecast(Context* context, const v1::MakeForecastRequest* request, v1::Operation* response) override;
  Reactor* EstimateRetention(Context* context, const v1::EstimateRetentionRequest* request,
                             v1::RetentionEstimate* response) override;

 private:
  Backend& backend_;
};

}  // namespace lipofill::server
