#include "server/simulations/shape_stream.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/entry/prepared_stream.h"
#include "server/store/record_names.h"
#include "server/wire/names.h"
#include "server/wire/request_key.h"
#include "server/wire/shape_conversion.h"
#include "server/wire/simulation_conversion.h"
#include "server/wire/violation_prefix.h"

namespace lipofill::server {
namespace {

/// The plan of a request; that of a simulation has what was injected since.
absl::StatusOr<v1::SimulationSpec> read_plan(Backend& backend, const v1::FindShapeRequest& request) {
  v1::SimulationSpec spec = request.spec();
  if (request.has_simulation()) {
    const auto id = parse_simulation_name(request.simulation(), "simulation");
    if (!id.ok()) return id.status();
    const auto record = backend.store.get_simulation(*id);
    if (!record.ok()) return record.status();
    if (!spec.ParseFromString(record->spec_message)) return absl::DataLossError("the plan cannot be read");
  } else {
    if (const auto name = parse_model_name(spec.model(), "spec.model"); !name.ok()) return name.status();
    if (absl::Status small = check_size(spec, backend.options.sizes); !small.ok()) return small;
  }
  return spec;
}

absl::StatusOr<std::unique_ptr<simulation::TrialShape>> make_trial(Backend& backend, const v1::SimulationSpec& spec) {
  const auto plan = to_simulation_spec(spec);
  if (!plan.ok()) return with_prefix("spec", plan.status());
  const auto model = backend.load_model(spec.model());
  if (!model.ok()) return model.status();
  auto made = simulation::TrialShape::create(*model, *plan);
  return made.ok() ? std::move(made) : with_prefix("spec", made.status());
}

absl::StatusOr<std::vector<v1::FindShapeResponse>> answer_with(const v1::FindShapeRequest& request,
                                                               const FoundTrial& found) {
  std::vector<simulation::ShapeSensitivity> sensitivities;
  if (request.with_sensitivities()) sensitivities = found.shape.find_sensitivities();
  return to_find_shape_responses(request, found, sensitivities);
}

absl::StatusOr<ShapeRequest> read_request(Backend& backend, grpc::CallbackServerContext* context,
                                          const v1::FindShapeRequest& request) {
  auto volumes = to_trial_volumes(request);
  if (!volumes.ok()) return volumes.status();
  auto spec = read_plan(backend, request);
  if (!spec.ok()) return spec.status();
  ShapeRequest order;
  order.plan = serialize_in_order(*spec);
  order.make = [&backend, spec = *std::move(spec)] { return make_trial(backend, spec); };
  order.volumes = *std::move(volumes);
  order.from_last = !request.from_rest();
  order.unwanted = caller_has_left(context);
  return order;
}

}  // namespace

grpc::ServerWriteReactor<v1::FindShapeResponse>* find_shape(Backend& backend, grpc::CallbackServerContext* context,
                                                            const v1::FindShapeRequest& request) {
  auto* stream = new PreparedStream<v1::FindShapeResponse>(context);
  const Principal& caller = call_of(context).principal;
  const absl::Status asked = guarded([&]() -> absl::Status {
    if (absl::Status valid = check_call(context, request); !valid.ok()) return valid;
    auto order = read_request(backend, context, request);
    if (!order.ok()) return order.status();
    order->reply = [&backend, stream, &request](const absl::Status& status, const FoundTrial* found) {
      std::vector<v1::FindShapeResponse> responses;
      const absl::Status answered = guarded([&]() -> absl::Status {
        if (!status.ok()) return status;
        auto made = answer_with(request, *found);
        if (made.ok()) responses = *std::move(made);
        return made.status();
      });
      backend.metrics.shapes().count(answered, found != nullptr ? found->preparing_s + found->finding_s : 0.0);
      if (answered.ok()) {
        stream->send(std::move(responses));
      } else {
        stream->fail(answered);
      }
    };
    backend.shapes.ask(caller.scope.tenant, absl::StrCat(caller.scope.tenant, "/", caller.subject), request.drag(),
                       *std::move(order));
    return absl::OkStatus();
  });
  if (!asked.ok()) stream->fail(asked);
  return stream;
}

}  // namespace lipofill::server
