#include "server/planning/forecast_calls.h"

#include <chrono>
#include <string>
#include <utility>

#include "core/base/field_violations.h"
#include "core/forecast/forecast.h"
#include "server/backend/long_work.h"
#include "server/backend/size_limits.h"
#include "server/wire/forecast_conversion.h"
#include "server/wire/model_conversion.h"
#include "server/wire/names.h"
#include "server/wire/operation_response.h"
#include "server/wire/request_key.h"
#include "server/wire/violation_prefix.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// Loading the model is the first part of the work.
constexpr double kLoaded = 0.05;
/// An answer has at most so many bytes; the rest of a message is for names and what goes around it.
constexpr size_t kMostBytes = 3'900'000;

/// A forecast that is to be made.
struct ForecastOrder {
  std::string model;
  forecast::ForecastRequest request;
  std::vector<forecast::UncertainInput> inputs;  ///< of the plan, but for retention
};

/// Lists what is uncertain of a model that need not be loaded for that.
absl::StatusOr<std::vector<forecast::UncertainInput>> inputs_on(const ModelRecord& record,
                                                                const forecast::ForecastRequest& request) {
  v1::ModelSpec message;
  if (!message.ParseFromString(record.spec_message)) return absl::DataLossError("the model cannot be read");
  const auto spec = to_face_model_spec(message);
  if (!spec.ok()) return spec.status();
  return forecast::choose_inputs(spec->layers, request.plan, request.inputs, request.only_named_inputs);
}

/// Checks a request without solving anything.
absl::StatusOr<ForecastOrder> read_request(Backend& backend, const std::string& patient,
                                           const v1::MakeForecastRequest& request) {
  if (!request.has_spec()) return field_violation("spec", "is missing");
  const v1::ForecastSpec& spec = request.spec();
  FieldViolations violations;
  auto converted = to_forecast_request(spec);
  violations.absorb("spec", converted.status());
  const auto model = parse_model_name(spec.plan().model(), "spec.plan.model");
  if (spec.has_plan()) violations.absorb("", model.status());
  if (model.ok() && model->patient != patient) violations.add("spec.plan.model", "is of another patient than parent");
  if (!violations.empty()) return violations.to_status();
  if (absl::Status small = check_size(spec.plan(), backend.options.sizes); !small.ok()) return small;
  const auto record = backend.store.get_model(model->patient, model->id);
  if (!record.ok()) return record.status();
  auto inputs = inputs_on(*record, *converted);
  if (!inputs.ok()) return with_prefix("spec", inputs.status());
  return ForecastOrder{spec.plan().model(), *std::move(converted), *std::move(inputs)};
}

absl::StatusOr<std::string> forecast_plan(Backend& backend, const std::string& operation, const ForecastOrder& order) {
  const auto started = std::chrono::steady_clock::now();
  if (!backend.operations.report(operation, 0.0, "loading the model")) {
    return absl::CancelledError("the operation was cancelled");
  }
  const auto model = backend.load_model(order.model);
  if (!model.ok()) return model.status();
  const auto progress = [&](double fraction, const char* stage) {
    return backend.operations.report(operation, kLoaded + (1.0 - kLoaded) * fraction, stage);
  };
  const auto made = forecast::make_forecast(*model, order.request, backend.options.workers, {}, progress);
  if (!made.ok()) return with_prefix("spec", made.status());
  v1::Forecast message = to_forecast(*made);
  if (message.ByteSizeLong() > kMostBytes) {
    for (v1::ForecastTime& time : *message.mutable_times()) {
      time.clear_mean_displacement_mm();
      time.clear_lift_p05_mm();
      time.clear_lift_p95_mm();
    }
    message.add_remarks(
        "The values of every vertex are left out: they are more than an answer holds. Ask for fewer months.");
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - started;
  message.set_wall_s(took.count());
  spdlog::info("operations/{} forecasts a plan from {} members of {}", operation, made->members - made->failed,
               made->members);
  return pack_response(message);
}

}  // namespace

absl::StatusOr<OperationView> start_forecast(Backend& backend, const Principal& caller,
                                             const v1::MakeForecastRequest& request) {
  const auto patient = parse_patient_name(request.parent(), "parent");
  if (!patient.ok()) return patient.status();
  if (auto good = check_request_id(request.request_id()); !good.ok()) return good;
  if (const auto known = backend.store.get_patient(*patient); !known.ok()) return known.status();
  auto order = read_request(backend, *patient, request);
  if (!order.ok()) return order.status();
  if (request.validate_only()) {
    return checked_only(request.parent(), to_forecast_inputs(order->inputs), "checked, not forecast");
  }
  return start_long_work(backend, request.parent(),
                         make_request_key(caller, "MakeForecast", request.request_id(), request),
                         "operations are waiting", "forecasts a plan of",
                         [&backend, order = *std::move(order)](const std::string& operation) {
                           return forecast_plan(backend, operation, order);
                         });
}

}  // namespace lipofill::server
