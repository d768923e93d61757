#include "server/patients/model_building.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/model/face_model_check.h"
#include "server/backend/long_work.h"
#include "server/backend/model_reading.h"
#include "server/backend/scan_reading.h"
#include "server/entry/unary.h"
#include "server/sessions/identifiers.h"
#include "server/store/record_names.h"
#include "server/wire/model_conversion.h"
#include "server/wire/names.h"
#include "server/wire/operation_response.h"
#include "server/wire/report_conversion.h"
#include "server/wire/request_key.h"
#include "server/wire/timestamps.h"
#include "server/wire/tissue_figures.h"
#include "server/wire/violation_prefix.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// Reading the scan is the first part of the work.
constexpr double kScanFraction = 0.05;

/// A model that is to be built: its specification as the client gave it and as the core takes it,
/// yet without the surfaces of its scans.
struct ModelOrder {
  std::string patient;
  v1::ModelSpec message;  ///< with the figures of its presets
  model::FaceModelSpec spec;
  ScanIds scans;
};

/// Checks a request without building anything; names fields below "spec".
absl::StatusOr<ModelOrder> read_request(Backend& backend, const std::string& patient,
                                        const v1::BuildModelRequest& request) {
  FieldViolations violations;
  if (!request.has_spec()) return field_violation("spec", "is missing");
  auto face = to_face_model_spec(request.spec());
  // It is enough here that there will be one.
  if (face.ok() && !request.spec().scan_region().bone_scan().empty()) face->bone.emplace();
  violations.absorb("spec", face.ok() ? model::check_face_model(*face) : face.status());
  auto scans = scans_of(patient, request.spec());
  violations.absorb("spec", scans.status());
  if (!violations.empty()) return violations.to_status();
  if (absl::Status small = check_size(request.spec(), backend.options.sizes); !small.ok()) return small;
  for (const auto& [scan, field] :
       {std::pair(scans->skin, "spec.scan_region.scan"), std::pair(scans->bone, "spec.scan_region.bone_scan")}) {
    if (scan.empty()) continue;
    if (absl::Status complete = check_complete(backend, patient, scan, field); !complete.ok()) return complete;
  }
  return ModelOrder{patient, fill_tissue_figures(request.spec()), *std::move(face), *std::move(scans)};
}

absl::StatusOr<ModelCache::Model> build(Backend& backend, const std::string& operation, const ModelOrder& order) {
  Operations& operations = backend.operations;
  const bool has_scan = !order.scans.skin.empty();
  if (!operations.report(operation, 0.0, has_scan ? "reading the scan" : "building")) {
    return absl::CancelledError("the operation was cancelled");
  }
  model::FaceModelSpec spec = order.spec;
  const absl::Status read = read_scans(backend, order.patient, order.scans, spec);
  if (!read.ok()) return with_prefix("spec", read);
  const double done = has_scan ? kScanFraction : 0.0;
  const auto progress = [&](double fraction, const char* stage) {
    return operations.report(operation, done + (1.0 - done) * fraction, stage);
  };
  auto model = model::build_face_model(spec, progress);
  if (!model.ok()) return with_prefix("spec", model.status());
  if (const absl::Status small = check_size(**model, backend.options.sizes); !small.ok()) return small;
  // The last moment at which a cancellation leaves nothing behind.
  if (!operations.report(operation, 1.0, "keeping the model")) {
    return absl::CancelledError("the operation was cancelled");
  }
  return model;
}

/// The model's report, in which what the readers of its scans passed over stands first.
v1::ModelReport report_on(Backend& backend, const ModelOrder& order, const model::FaceModel& model) {
  v1::ModelReport report = to_model_report(model);
  std::vector<std::string> remarks;
  for (const auto& [scan, prefix] : {std::pair(order.scans.skin, ""), std::pair(order.scans.bone, "Bone: ")}) {
    if (scan.empty()) continue;
    const auto record = backend.store.get_scan(order.patient, scan);
    v1::ScanReport read;
    if (!record.ok() || !read.ParseFromString(record->report_message)) continue;
    for (const std::string& remark : read.read_remarks()) remarks.push_back(absl::StrCat(prefix, remark));
  }
  remarks.insert(remarks.end(), report.scan_remarks().begin(), report.scan_remarks().end());
  report.mutable_scan_remarks()->Assign(remarks.begin(), remarks.end());
  return report;
}

absl::StatusOr<std::string> build_and_keep(Backend& backend, const std::string& operation, const ModelOrder& order,
                                           const RequestKey& request) {
  const auto model = build(backend, operation, order);
  if (!model.ok()) return model.status();
  ModelRecord record;
  record.patient = order.patient;
  record.id = make_id('m');
  record.scan = order.scans.skin;
  record.bone_scan = order.scans.bone;
  record.content_hash = (*model)->content_hash;
  record.spec_message = with_chosen_sizes(order.message, **model).SerializeAsString();
  record.report_message = report_on(backend, order, **model).SerializeAsString();
  record.create_time_us = now_us();
  const auto kept = backend.store.create_model(record, request);
  if (!kept.ok()) return kept.status();
  backend.models.put(model_name(kept->patient, kept->id), *model);
  spdlog::info("{} built from {} hexahedra, {}", model_name(kept->patient, kept->id),
               (*model)->geometry.grid.n_hexahedra(), kept->content_hash);
  return pack_response(to_model(*kept));
}

/// The operation of an equal request before a restart, of which the model is left.
absl::StatusOr<std::optional<OperationView>> find_earlier(Backend& backend, const std::string& patient,
                                                          const RequestKey& request) {
  const auto name = backend.store.find_request(request);
  if (!name.ok()) return name.status();
  if (!name->has_value()) return std::nullopt;
  const auto ids = parse_model_name(**name, "");
  if (!ids.ok()) return ids.status();
  const auto record = backend.store.get_model(ids->patient, ids->id);
  if (!record.ok()) return record.status();
  return backend.operations.add_done(patient_name(patient), request, pack_response(to_model(*record)));
}

}  // namespace

v1::Model to_model(const ModelRecord& record) {
  v1::Model model;
  model.set_name(model_name(record.patient, record.id));
  model.mutable_spec()->ParseFromString(record.spec_message);
  model.mutable_report()->ParseFromString(record.report_message);
  *model.mutable_create_time() = to_timestamp(record.create_time_us);
  return model;
}

absl::StatusOr<OperationView> start_model_build(Backend& backend, const Principal& caller,
                                                const v1::BuildModelRequest& request) {
  const auto patient = parse_patient_name(request.parent(), "parent");
  if (!patient.ok()) return patient.status();
  if (auto good = check_request_id(request.request_id()); !good.ok()) return good;
  if (const auto known = backend.store.get_patient(*patient); !known.ok()) return known.status();
  auto order = read_request(backend, *patient, request);
  if (!order.ok()) return order.status();
  if (request.validate_only()) {
    v1::Model model;
    *model.mutable_spec() = order->message;
    return checked_only(request.parent(), model, "checked, not built");
  }
  const RequestKey key = make_request_key(caller, "BuildModel", request.request_id(), request);
  const auto earlier = find_earlier(backend, *patient, key);
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return **earlier;
  return start_long_work(backend, request.parent(), key, "models are waiting to be built", "builds a model of",
                         [&backend, key, order = *std::move(order)](const std::string& operation) {
                           return build_and_keep(backend, operation, order, key);
                         });
}

}  // namespace lipofill::server
