#include "absl/strings/str_cat.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/store/scope_query.h"
#include "server/store/sql_store.h"

namespace lipofill::server {
namespace {

absl::Status no_patient(const std::string& id) {
  return absl::NotFoundError(absl::StrCat("there is no ", patient_name(id)));
}

}  // namespace

absl::StatusOr<PatientRecord> SqlStore::create_patient(const PatientRecord& patient, const RequestKey& request) {
  const auto earlier = transact_once(request, patient_name(patient.id), [&] { return write_patient(patient); });
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return get_patient((**earlier).substr(patient_name("").size()));
  return patient;
}

absl::Status SqlStore::write_patient(const PatientRecord& patient) {
  Query insert(*database_, "INSERT INTO patients (id, display_name, create_time_us, tenant) VALUES (?, ?, ?, ?)");
  const auto done = insert.bind(patient.id, patient.display_name, patient.create_time_us, patient.tenant).run();
  if (absl::IsAlreadyExists(done)) {
    return absl::AlreadyExistsError(absl::StrCat(patient_name(patient.id), " exists"));
  }
  return done.ok() ? write_labels(patient) : done;
}

absl::Status SqlStore::write_labels(const PatientRecord& patient) {
  Query clear(*database_, "DELETE FROM patient_labels WHERE patient = ?");
  absl::Status done = clear.bind(patient.id).run();
  for (const auto& [key, value] : patient.labels) {
    Query insert(*database_, "INSERT INTO patient_labels (" LABEL_COLUMNS ") VALUES (?, ?, ?)");
    done.Update(insert.bind(patient.id, key, value).run());
  }
  return done;
}

absl::StatusOr<PatientRecord> SqlStore::get_patient(const std::string& id) {
  return turns_.look([&] { return read_patient(id); });
}

absl::StatusOr<PatientRecord> SqlStore::read_patient(const std::string& id) {
  Query query(*database_, "SELECT display_name, create_time_us, tenant, " IS_WHOLE(
                              "patients", PATIENT_COLUMNS) " FROM patients WHERE id = ?");
  if (!query.bind(id).next()) {
    if (!query.status().ok()) return query.status();
    return no_patient(id);
  }
  if (!query.is_true(3)) return damaged_record(patient_name(id));
  PatientRecord patient{id, query.text(0), {}, query.integer(1), query.text(2)};
  Query labels(*database_, "SELECT key, value, " IS_WHOLE("patient_labels",
                                                          LABEL_COLUMNS) " FROM patient_labels WHERE patient = ?");
  labels.bind(id);
  while (labels.next()) {
    if (!labels.is_true(2)) return damaged_record(patient_name(id));
    patient.labels[labels.text(0)] = labels.text(1);
  }
  if (!labels.status().ok()) return labels.status();
  return patient;
}

absl::StatusOr<std::vector<PatientRecord>> SqlStore::list_patients(const Scope& scope, const Page& page) {
  return turns_.look([&]() -> absl::StatusOr<std::vector<PatientRecord>> {
    std::vector<std::string> ids;
    Query query(*database_, "SELECT id FROM patients WHERE tenant = ?1 AND id > ?2 AND " IS_AMONG(
                                "id", "?3", "?4") " ORDER BY id LIMIT ?5");
    query.bind(scope.tenant, page.after, !scope.patients, patients_of(scope), page.size);
    while (query.next()) ids.push_back(query.text(0));
    if (!query.status().ok()) return query.status();
    std::vector<PatientRecord> patients;
    for (const std::string& id : ids) {
      auto patient = read_patient(id);
      if (absl::IsDataLoss(patient.status())) {
        patient = PatientRecord();
        patient->id = id;
        patient->is_damaged = true;
      }
      if (!patient.ok()) return patient.status();
      patients.push_back(*std::move(patient));
    }
    return patients;
  });
}

absl::StatusOr<Owner> SqlStore::owner_of_patient(const std::string& id) {
  return turns_.look([&]() -> absl::StatusOr<Owner> {
    Query query(*database_, "SELECT tenant, " IS_WHOLE("patients", PATIENT_COLUMNS) " FROM patients WHERE id = ?");
    if (!query.bind(id).next()) return query.status().ok() ? no_patient(id) : query.status();
    if (!query.is_true(1)) return damaged_record(patient_name(id));
    return Owner{query.text(0), id};
  });
}

absl::StatusOr<PatientRecord> SqlStore::update_patient(const std::string& id, const PatientChange& change) {
  return turns_.transact([&]() -> absl::StatusOr<PatientRecord> {
    auto patient = read_patient(id);
    if (patient.ok()) patient = change(*patient);
    if (!patient.ok()) return patient.status();
    Query update(*database_, "UPDATE patients SET display_name = ? WHERE id = ?");
    absl::Status done = update.bind(patient->display_name, id).run();
    if (done.ok()) done = write_labels(*patient);
    if (!done.ok()) return done;
    return patient;
  });
}

absl::Status SqlStore::delete_patient(const std::string& id, bool force, const PatientCheck& check) {
  return turns_.transact([&]() -> absl::Status {
    const auto patient = read_patient(id);
    // What is damaged can go, unless it is to be checked first.
    absl::Status fits = absl::IsDataLoss(patient.status()) && check == nullptr ? absl::OkStatus() : patient.status();
    if (fits.ok() && check != nullptr) fits = check(*patient);
    if (fits.ok() && !force) fits = check_empty(id);
    if (fits.ok()) fits = check_unused(patient_name(id) + "/", patient_name(id) + "0");
    if (!fits.ok()) return fits;
    Query remove(*database_, "DELETE FROM patients WHERE id = ?");
    const absl::Status removed = remove.bind(id).run();
    return removed.ok() ? forget_requests(patient_name(id)) : removed;
  });
}

absl::Status SqlStore::check_empty(const std::string& patient) {
  Query count(
      *database_,
      "SELECT (SELECT count(*) FROM scans WHERE patient = ?1), (SELECT count(*) FROM models WHERE patient = ?1), "
      "(SELECT count(*) FROM plans WHERE patient = ?1)");
  if (!count.bind(patient).next()) return count.status();
  if (count.integer(0) + count.integer(1) + count.integer(2) == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(patient_name(patient), " has ", count.integer(0), " scans and ",
                                                    count.integer(1), " models and ", count.integer(2),
                                                    " plans; delete them first, or force"));
}

}  // namespace lipofill::server
