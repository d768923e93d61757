#include "server/planning/forecast_service.h"

#include "server/entry/operation_answer.h"
#include "server/entry/unary.h"
#include "server/planning/forecast_calls.h"
#include "server/wire/forecast_conversion.h"

namespace lipofill::server {

ForecastService::Reactor* ForecastService::MakeForecast(Context* context, const v1::MakeForecastRequest* request,
                                                        v1::Operation* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto operation = start_forecast(backend_, call_of(context).principal, *request);
    if (operation.ok()) *response = to_operation(backend_, *operation);
    return operation.status();
  });
}

ForecastService::Reactor* ForecastService::EstimateRetention(Context* context,
                                                             const v1::EstimateRetentionRequest* request,
                                                             v1::RetentionEstimate* response) {
  return answer(context, request, [&]() -> absl::Status {
    auto estimate = estimate_retention(*request);
    if (estimate.ok()) *response = *std::move(estimate);
    return estimate.status();
  });
}

}  // namespace lipofill::server
