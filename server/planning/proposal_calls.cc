#include "server/planning/proposal_calls.h"

#include <chrono>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/planning/proposal.h"
#include "server/backend/long_work.h"
#include "server/backend/scan_reading.h"
#include "server/backend/size_limits.h"
#include "server/wire/names.h"
#include "server/wire/operation_response.h"
#include "server/wire/proposal_conversion.h"
#include "server/wire/request_key.h"
#include "server/wire/violation_prefix.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// Loading model and target is the first part of the work.
constexpr double kLoaded = 0.1;

/// A proposal that is to be made.
struct ProposalOrder {
  v1::ProposalSpec spec;
  planning::ProposalRequest request;
  PatientChild target;
};

/// Checks a request without solving anything.
absl::StatusOr<ProposalOrder> read_request(Backend& backend, const std::string& patient,
                                           const v1::ProposePlanRequest& request) {
  if (!request.has_spec()) return field_violation("spec", "is missing");
  FieldViolations violations;
  auto converted = to_proposal_request(request.spec());
  violations.absorb("spec", converted.status());
  const auto model = parse_model_name(request.spec().plan().model(), "spec.plan.model");
  if (request.spec().has_plan()) violations.absorb("", model.status());
  const auto target = parse_scan_name(request.spec().target_scan(), "spec.target_scan");
  violations.absorb("", target.status());
  if (model.ok() && model->patient != patient) violations.add("spec.plan.model", "is of another patient than parent");
  if (target.ok() && target->patient != patient)
    violations.add("spec.target_scan", "is of another patient than parent");
  if (!violations.empty()) return violations.to_status();
  if (absl::Status small = check_size(request.spec().plan(), backend.options.sizes); !small.ok()) return small;
  if (const auto record = backend.store.get_model(model->patient, model->id); !record.ok()) return record.status();
  if (absl::Status complete = check_complete(backend, target->patient, target->id, "spec.target_scan");
      !complete.ok()) {
    return complete;
  }
  return ProposalOrder{request.spec(), *std::move(converted), *target};
}

absl::StatusOr<std::string> propose(Backend& backend, const std::string& operation, const ProposalOrder& order) {
  const auto started = std::chrono::steady_clock::now();
  if (!backend.operations.report(operation, 0.0, "loading model and target")) {
    return absl::CancelledError("the operation was cancelled");
  }
  const auto model = backend.load_model(order.spec.plan().model());
  if (!model.ok()) return model.status();
  const auto target = read_scan_surface(backend, order.target.patient, order.target.id);
  if (!target.ok()) return target.status();
  const auto progress = [&](double fraction, const char* stage) {
    return backend.operations.report(operation, kLoaded + (1.0 - kLoaded) * fraction, stage);
  };
  const auto proposal = planning::propose_plan(*model, *target, order.request, progress);
  if (!proposal.ok()) return with_prefix("spec", proposal.status());
  v1::Proposal message = to_proposal(order.spec, *proposal);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - started;
  message.set_wall_s(took.count());
  spdlog::info("operations/{} proposes {} mL in {} zones after {} solves", operation, message.total_ml(),
               message.volumes_size(), message.solves());
  return pack_response(message);
}

}  // namespace

absl::StatusOr<OperationView> start_proposal(Backend& backend, const Principal& caller,
                                             const v1::ProposePlanRequest& request) {
  const auto patient = parse_patient_name(request.parent(), "parent");
  if (!patient.ok()) return patient.status();
  if (auto good = check_request_id(request.request_id()); !good.ok()) return good;
  if (const auto known = backend.store.get_patient(*patient); !known.ok()) return known.status();
  auto order = read_request(backend, *patient, request);
  if (!order.ok()) return order.status();
  if (request.validate_only()) {
    v1::Proposal unchanged;
    *unchanged.mutable_plan() = request.spec().plan();
    return checked_only(request.parent(), unchanged, "checked, not proposed");
  }
  return start_long_work(backend, request.parent(),
                         make_request_key(caller, "ProposePlan", request.request_id(), request),
                         "operations are waiting", "proposes a plan for",
                         [&backend, order = *std::move(order)](const std::string& operation) {
                           return propose(backend, operation, order);
                         });
}

}  // namespace lipofill::server
