#include "server/patients/patient_service.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "server/entry/listing.h"
#include "server/entry/operation_answer.h"
#include "server/entry/unary.h"
#include "server/patients/mesh_download.h"
#include "server/patients/model_building.h"
#include "server/security/refusals.h"
#include "server/sessions/identifiers.h"
#include "server/store/record_names.h"
#include "server/wire/etag.h"
#include "server/wire/field_mask.h"
#include "server/wire/names.h"
#include "server/wire/request_key.h"
#include "server/wire/timestamps.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

constexpr int kMaxLabels = 64;

v1::Patient to_patient(const PatientRecord& record) {
  v1::Patient patient;
  patient.set_name(patient_name(record.id));
  patient.set_display_name(record.display_name);
  patient.mutable_labels()->insert(record.labels.begin(), record.labels.end());
  patient.set_etag(make_etag(record));
  *patient.mutable_create_time() = to_timestamp(record.create_time_us);
  return patient;
}

/// Labels follow the rule of display names: pseudonyms have no use for more, and identities do not
/// fit well.
template <typename Labels>
absl::StatusOr<std::map<std::string, std::string>> read_labels(const Labels& labels, const std::string& field) {
  FieldViolations violations;
  if (labels.size() > kMaxLabels) {
    violations.add(field, absl::StrCat("are ", labels.size(), ", must be at most ", kMaxLabels));
  }
  const std::map<std::string, std::string> sorted(labels.begin(), labels.end());
  for (const auto& [key, value] : sorted) {
    if (violations.all().size() >= 10) break;
    if (key.empty()) violations.add(field, "has an empty key");
    violations.absorb("", check_display_name(key, field));
    violations.absorb("", check_display_name(value, absl::StrCat(field, "[", key.substr(0, 63), "]")));
  }
  if (!violations.empty()) return violations.to_status();
  return sorted;
}

absl::Status create_patient(Backend& backend, const Principal& caller, const v1::CreatePatientRequest& request,
                            v1::Patient& response) {
  FieldViolations violations;
  violations.absorb("", check_request_id(request.request_id()));
  const auto id = id_or_new(request.patient_id(), 'p', "patient_id", caller.scope.tenant);
  violations.absorb("", id.status());
  violations.absorb("", check_display_name(request.display_name(), "display_name"));
  const auto labels = read_labels(request.labels(), "labels");
  violations.absorb("", labels.status());
  if (!violations.empty()) return violations.to_status();
  if (!caller.scope.has(caller.scope.tenant, *id)) {
    return permission_denied("PATIENT_NOT_YOURS",
                             "the caller is limited to certain patients, this one is not among them");
  }
  const PatientRecord draft{*id, request.display_name(), *labels, now_us(), caller.scope.tenant};
  if (request.validate_only()) {
    if (backend.store.get_patient(*id).ok()) return absl::AlreadyExistsError(patient_name(*id) + " exists");
    response = to_patient(draft);
    return absl::OkStatus();
  }
  const auto made =
      backend.store.create_patient(draft, make_request_key(caller, "CreatePatient", request.request_id(), request));
  if (!made.ok()) return made.status();
  spdlog::info("{} created", patient_name(made->id));
  response = to_patient(*made);
  return absl::OkStatus();
}

/// The fields of a patient that may change.
absl::Status check_update_mask(const v1::UpdatePatientRequest& request) {
  if (auto good = check_field_mask(request.update_mask(), *v1::Patient::descriptor(), "update_mask"); !good.ok()) {
    return good;
  }
  for (const std::string& path : request.update_mask().paths()) {
    if (path != "display_name" && path != "labels" && path != "*") {
      return field_violation("update_mask", "names " + path + "; only display_name and labels can change");
    }
  }
  return absl::OkStatus();
}

absl::Status update_patient(Backend& backend, const v1::UpdatePatientRequest& request, v1::Patient& response) {
  FieldViolations violations;
  const v1::Patient& given = request.patient();
  const auto id = parse_patient_name(given.name(), "patient.name");
  violations.absorb("", id.status());
  violations.absorb("", check_update_mask(request));
  violations.absorb("", check_display_name(given.display_name(), "patient.display_name"));
  const auto labels = read_labels(given.labels(), "patient.labels");
  violations.absorb("", labels.status());
  if (!violations.empty()) return violations.to_status();

  const auto change = [&](const PatientRecord& present) -> absl::StatusOr<PatientRecord> {
    if (auto fits = check_etag(given.etag(), make_etag(present), "patient.etag"); !fits.ok()) return fits;
    PatientRecord changed = present;
    if (is_masked(request.update_mask(), "display_name")) changed.display_name = given.display_name();
    if (is_masked(request.update_mask(), "labels")) changed.labels = *labels;
    return changed;
  };
  auto updated = backend.store.get_patient(*id);
  if (updated.ok()) updated = request.validate_only() ? change(*updated) : backend.store.update_patient(*id, change);
  if (updated.ok()) response = to_patient(*updated);
  return updated.status();
}

absl::Status delete_patient(Backend& backend, const v1::DeletePatientRequest& request) {
  const auto id = parse_patient_name(request.name(), "name");
  if (!id.ok()) return id.status();
  Store::PatientCheck check;
  if (!request.etag().empty()) {
    check = [&request](const PatientRecord& present) { return check_etag(request.etag(), make_etag(present), "etag"); };
  }
  const absl::Status done =
      backend.reserve.spend([&] { return backend.store.delete_patient(*id, request.force(), check); });
  if (!done.ok()) return done;
  backend.temporary_files.remove_deleted();
  spdlog::info("{} deleted", request.name());
  return absl::OkStatus();
}

}  // namespace

// ---- patients

PatientService::Reactor* PatientService::CreatePatient(Context* context, const v1::CreatePatientRequest* request,
                                                       v1::Patient* response) {
  return answer(context, request,
                [&] { return create_patient(backend_, call_of(context).principal, *request, *response); });
}

PatientService::Reactor* PatientService::GetPatient(Context* context, const v1::GetPatientRequest* request,
                                                    v1::Patient* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto id = parse_patient_name(request->name(), "name");
    if (!id.ok()) return id.status();
    const auto patient = backend_.store.get_patient(*id);
    if (patient.ok()) *response = to_patient(*patient);
    return patient.status();
  });
}

PatientService::Reactor* PatientService::ListPatients(Context* context, const v1::ListPatientsRequest* request,
                                                      v1::ListPatientsResponse* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto page = parse_page("patients", request->page_size(), request->page_token());
    if (!page.ok()) return page.status();
    const auto patients = backend_.store.list_patients(call_of(context).principal.scope, one_more(*page));
    if (!patients.ok()) return patients.status();
    response->set_next_page_token(fill_page("patients", *page, *patients, [response](const PatientRecord& patient) {
      if (patient.is_damaged) return add_unreachable(patient_name(patient.id), *response);
      *response->add_patients() = to_patient(patient);
    }));
    return absl::OkStatus();
  });
}

PatientService::Reactor* PatientService::UpdatePatient(Context* context, const v1::UpdatePatientRequest* request,
                                                       v1::Patient* response) {
  return answer(context, request, [&] { return update_patient(backend_, *request, *response); });
}

PatientService::Reactor* PatientService::DeletePatient(Context* context, const v1::DeletePatientRequest* request,
                                                       google::protobuf::Empty*) {
  return answer(context, request, [&] { return delete_patient(backend_, *request); });
}

// ---- scans

PatientService::Reactor* PatientService::CreateScan(Context* context, const v1::CreateScanRequest* request,
                                                    v1::Scan* response) {
  return answer(context, request, [&] {
    auto scan = uploads_.create(call_of(context).principal, *request);
    if (scan.ok()) *response = *std::move(scan);
    return scan.status();
  });
}

grpc::ServerReadReactor<v1::UploadScanRequest>* PatientService::UploadScan(Context* context, v1::Scan* response) {
  return uploads_.upload(context, response);
}

PatientService::Reactor* PatientService::GetScan(Context* context, const v1::GetScanRequest* request,
                                                 v1::Scan* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto ids = parse_scan_name(request->name(), "name");
    if (!ids.ok()) return ids.status();
    const auto scan = uploads_.find(ids->patient, ids->id);
    if (scan.ok()) *response = to_scan(*scan);
    return scan.status();
  });
}

PatientService::Reactor* PatientService::ListScans(Context* context, const v1::ListScansRequest* request,
                                                   v1::ListScansResponse* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto patient = parse_patient_name(request->parent(), "parent");
    if (!patient.ok()) return patient.status();
    const std::string collection = request->parent() + "/scans";
    const auto page = parse_page(collection, request->page_size(), request->page_token());
    if (!page.ok()) return page.status();
    const auto scans = backend_.store.list_scans(*patient, one_more(*page));
    if (!scans.ok()) return scans.status();
    response->set_next_page_token(fill_page(collection, *page, *scans, [response](const ScanRecord& scan) {
      if (scan.is_damaged) return add_unreachable(scan_name(scan.patient, scan.id), *response);
      *response->add_scans() = to_scan(scan);
    }));
    return absl::OkStatus();
  });
}

PatientService::Reactor* PatientService::DeleteScan(Context* context, const v1::DeleteScanRequest* request,
                                                    google::protobuf::Empty*) {
  return answer(context, request, [&]() -> absl::Status {
    const auto ids = parse_scan_name(request->name(), "name");
    if (!ids.ok()) return ids.status();
    const absl::Status done = backend_.reserve.spend([&] { return backend_.store.delete_scan(ids->patient, ids->id); });
    if (!done.ok()) return done;
    backend_.temporary_files.remove_deleted();
    spdlog::info("{} deleted", request->name());
    return absl::OkStatus();
  });
}

// ---- models

PatientService::Reactor* PatientService::BuildModel(Context* context, const v1::BuildModelRequest* request,
                                                    v1::Operation* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto operation = start_model_build(backend_, call_of(context).principal, *request);
    if (operation.ok()) *response = to_operation(backend_, *operation);
    return operation.status();
  });
}

PatientService::Reactor* PatientService::GetModel(Context* context, const v1::GetModelRequest* request,
                                                  v1::Model* response) {
  const auto read = [&]() -> absl::Status {
    const auto ids = parse_model_name(request->name(), "name");
    if (!ids.ok()) return ids.status();
    const auto model = backend_.store.get_model(ids->patient, ids->id);
    if (model.ok()) *response = to_model(*model);
    return model.status();
  };
  return answer(context, request, [&] { return read_masked(*request, *response, read); });
}

PatientService::Reactor* PatientService::ListModels(Context* context, const v1::ListModelsRequest* request,
                                                    v1::ListModelsResponse* response) {
  return answer(context, request, [&]() -> absl::Status {
    const auto patient = parse_patient_name(request->parent(), "parent");
    if (!patient.ok()) return patient.status();
    const auto& mask = request->read_mask();
    if (auto good = check_field_mask(mask, *v1::Model::descriptor(), "read_mask"); !good.ok()) return good;
    const std::string collection = request->parent() + "/models";
    const auto page = parse_page(collection, request->page_size(), request->page_token());
    if (!page.ok()) return page.status();
    const auto models = backend_.store.list_models(*patient, one_more(*page));
    if (!models.ok()) return models.status();
    response->set_next_page_token(fill_page(collection, *page, *models, [&](const ModelRecord& model) {
      if (model.is_damaged) return add_unreachable(model_name(model.patient, model.id), *response);
      *response->add_models() = to_model(model);
      apply_field_mask(mask, *response->mutable_models()->rbegin());
    }));
    return absl::OkStatus();
  });
}

PatientService::Reactor* PatientService::DeleteModel(Context* context, const v1::DeleteModelRequest* request,
                                                     google::protobuf::Empty*) {
  return answer(context, request, [&]() -> absl::Status {
    const auto ids = parse_model_name(request->name(), "name");
    if (!ids.ok()) return ids.status();
    const absl::Status done =
        backend_.reserve.spend([&] { return backend_.store.delete_model(ids->patient, ids->id); });
    if (!done.ok()) return done;
    backend_.models.remove(request->name());
    spdlog::info("{} deleted", request->name());
    return absl::OkStatus();
  });
}

grpc::ServerWriteReactor<v1::MeshSlice>* PatientService::DownloadScanMesh(Context* context,
                                                                          const v1::DownloadScanMeshRequest* request) {
  return download_scan_mesh(backend_, context, *request);
}

grpc::ServerWriteReactor<v1::MeshSlice>* PatientService::DownloadModelMesh(
    Context* context, const v1::DownloadModelMeshRequest* request) {
  return download_model_mesh(backend_, context, *request);
}

}  // namespace lipofill::server
