#include "server/planning/target_making.h"

#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/geometry/ply_writer.h"
#include "core/geometry/surface_reader.h"
#include "core/planning/target.h"
#include "server/backend/long_work.h"
#include "server/backend/scan_reading.h"
#include "server/sessions/identifiers.h"
#include "server/store/record_names.h"
#include "server/wire/names.h"
#include "server/wire/operation_response.h"
#include "server/wire/report_conversion.h"
#include "server/wire/request_key.h"
#include "server/wire/sha256.h"
#include "server/wire/target_conversion.h"
#include "server/wire/timestamps.h"
#include "server/wire/violation_prefix.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

constexpr char kMethod[] = "MakeTarget";
constexpr double kRead = 0.1;  // of the work: reading the scans
constexpr double kMade = 0.9;

/// A target that is to be made.
struct TargetOrder {
  std::string patient;
  v1::TargetSpec spec;
  TargetRequest request;
  std::string scan;     ///< id
  std::string surface;  ///< id; empty for a mirrored side
  RequestKey key;
};

/// The id of a scan of this patient that is complete.
absl::StatusOr<std::string> find_scan(Backend& backend, const std::string& patient, const std::string& name,
                                      const std::string& field) {
  const auto ids = parse_scan_name(name, field);
  if (!ids.ok()) return ids.status();
  if (ids->patient != patient) return field_violation(field, "is of another patient than parent");
  if (absl::Status complete = check_complete(backend, patient, ids->id, field); !complete.ok()) return complete;
  return ids->id;
}

/// Checks a request without making anything.
absl::StatusOr<TargetOrder> read_request(Backend& backend, const std::string& patient,
                                         const v1::MakeTargetRequest& request) {
  if (!request.has_spec()) return field_violation("spec", "is missing");
  auto target = to_target_request(request.spec());
  if (!target.ok()) return with_prefix("spec", target.status());
  const auto scan = find_scan(backend, patient, request.spec().scan(), "spec.scan");
  if (!scan.ok()) return scan.status();
  std::string surface;
  if (request.spec().has_surface()) {
    const auto found = find_scan(backend, patient, request.spec().surface().scan(), "spec.surface.scan");
    if (!found.ok()) return found.status();
    surface = *found;
  }
  return TargetOrder{patient, request.spec(), *std::move(target), *scan, surface, {}};
}

v1::Target to_target(const ScanRecord& record) {
  v1::ScanReport report;
  report.ParseFromString(record.report_message);
  v1::Target target;
  target.set_scan(scan_name(record.patient, record.id));
  *target.mutable_report() = report.target();
  return target;
}

absl::StatusOr<planning::Target> make(Backend& backend, const std::string& operation, const TargetOrder& order) {
  if (!backend.operations.report(operation, 0.0, "reading the scans")) {
    return absl::CancelledError("the operation was cancelled");
  }
  auto face = read_scan_surface(backend, order.patient, order.scan);
  if (!face.ok()) return face.status();
  const char* stage = order.request.healthy_side ? "finding the plane of symmetry" : "placing the surface";
  const Unwanted unwanted = [&] { return !backend.operations.report(operation, kRead, stage); };
  const planning::MarkedScan marked{*std::move(face), order.request.landmarks};
  if (order.request.healthy_side) {
    return planning::make_mirrored_target(marked, *order.request.healthy_side, unwanted);
  }
  auto surface = read_scan_surface(backend, order.patient, order.surface);
  if (!surface.ok()) return surface.status();
  return planning::make_surface_target(marked, {*std::move(surface), order.request.surface_landmarks},
                                       order.request.placement, unwanted);
}

/// Keeps the target as a complete scan. Equal requests make equal bytes, so that one that was
/// broken off is taken up again.
absl::StatusOr<ScanRecord> keep(Backend& backend, const TargetOrder& order, const planning::Target& target) {
  const std::string bytes = geometry::write_ply(target.surface);
  if (bytes.size() > backend.options.sizes.upload_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the target has ", bytes.size(), " bytes, scans have at most ",
                                                     backend.options.sizes.upload_bytes));
  }
  v1::ScanReport report = to_scan_report(target.surface, geometry::check_surface(target.surface));
  *report.mutable_target() = to_target_report(order.spec, target);
  ScanRecord record;
  record.patient = order.patient;
  record.id = make_id('s');
  record.format = v1::PLY;
  record.unit = v1::METRE;
  record.size_bytes = bytes.size();
  record.sha256 = compute_sha256(bytes);
  record.create_time_us = now_us();
  auto kept = backend.store.create_scan(record, order.key);
  if (!kept.ok() || kept->complete) return kept;
  absl::Status done = backend.scan_files.write(kept->patient, kept->id, 0, bytes);
  if (done.ok()) done = backend.scan_files.flush(kept->patient, kept->id);
  if (done.ok()) done = backend.store.set_scan_received(kept->patient, kept->id, bytes.size());
  if (done.ok()) done = backend.store.complete_scan(kept->patient, kept->id, report.SerializeAsString());
  if (!done.ok()) return done;
  kept->complete = true;
  kept->report_message = report.SerializeAsString();
  return kept;
}

absl::StatusOr<std::string> make_and_keep(Backend& backend, const std::string& operation, const TargetOrder& order) {
  const auto target = make(backend, operation, order);
  if (!target.ok()) return with_prefix("spec", target.status());
  // The last moment at which a cancellation leaves nothing behind.
  if (!backend.operations.report(operation, kMade, "keeping the target")) {
    return absl::CancelledError("the operation was cancelled");
  }
  const auto kept = keep(backend, order, *target);
  if (!kept.ok()) return kept.status();
  spdlog::info("{} is a target for {}", scan_name(kept->patient, kept->id), order.spec.scan());
  return pack_response(to_target(*kept));
}

/// The operation of an equal request before a restart, of which the target is left.
absl::StatusOr<std::optional<OperationView>> find_earlier(Backend& backend, const TargetOrder& order) {
  const auto name = backend.store.find_request(order.key);
  if (!name.ok()) return name.status();
  if (!name->has_value()) return std::nullopt;
  const auto ids = parse_scan_name(**name, "");
  if (!ids.ok()) return ids.status();
  const auto record = backend.store.get_scan(ids->patient, ids->id);
  if (!record.ok()) return record.status();
  if (!record->complete) return std::nullopt;
  return backend.operations.add_done(patient_name(order.patient), order.key, pack_response(to_target(*record)));
}

}  // namespace

absl::StatusOr<OperationView> start_target(Backend& backend, const Principal& caller,
                                           const v1::MakeTargetRequest& request) {
  const auto patient = parse_patient_name(request.parent(), "parent");
  if (!patient.ok()) return patient.status();
  if (auto good = check_request_id(request.request_id()); !good.ok()) return good;
  if (const auto known = backend.store.get_patient(*patient); !known.ok()) return known.status();
  auto order = read_request(backend, *patient, request);
  if (!order.ok()) return order.status();
  if (request.validate_only()) return checked_only(request.parent(), v1::Target(), "checked, not made");
  order->key = make_request_key(caller, kMethod, request.request_id(), request);
  const auto earlier = find_earlier(backend, *order);
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return **earlier;
  const RequestKey key = order->key;
  return start_long_work(backend, request.parent(), key, "operations are waiting", "makes a target for",
                         [&backend, order = *std::move(order)](const std::string& operation) {
                           return make_and_keep(backend, operation, order);
                         });
}

}  // namespace lipofill::server
