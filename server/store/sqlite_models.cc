#include "absl/strings/str_cat.h"
#include "server/store/record_names.h"
#include "server/store/sqlite_store.h"

namespace lipofill::server {
namespace {

#define MODEL_COLUMNS "patient, id, scan, content_hash, spec, report, create_time_us, bone_scan"

ModelRecord model_of(const Query& row) {
  return {row.text(0), row.text(1), row.text(2), row.text(3), row.text(4), row.text(5), row.integer(6), row.text(7)};
}

absl::Status no_model(const std::string& patient, const std::string& id) {
  return absl::NotFoundError(absl::StrCat("there is no ", model_name(patient, id)));
}

}  // namespace

absl::StatusOr<ModelRecord> SqliteStore::create_model(const ModelRecord& model, const RequestKey& request) {
  const auto earlier = transact_once(request, model_name(model.patient, model.id), [&] { return write_model(model); });
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return get_model(model.patient, (**earlier).substr(model_name(model.patient, "").size()));
  return model;
}

absl::Status SqliteStore::write_model(const ModelRecord& model) {
  if (const auto patient = read_patient(model.patient); !patient.ok()) return patient.status();
  for (const std::string& id : {model.scan, model.bone_scan}) {
    if (id.empty()) continue;
    if (const auto scan = read_scan(model.patient, id); !scan.ok()) return scan.status();
  }
  Query insert(*database_, "INSERT INTO models (" MODEL_COLUMNS ") VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  return insert
      .bind(model.patient, model.id, model.scan, model.content_hash, model.spec_message, model.report_message,
            model.create_time_us, model.bone_scan)
      .run();
}

absl::StatusOr<ModelRecord> SqliteStore::get_model(const std::string& patient, const std::string& id) {
  const std::lock_guard lock(mutex_);
  return read_model(patient, id);
}

absl::StatusOr<ModelRecord> SqliteStore::read_model(const std::string& patient, const std::string& id) {
  Query query(*database_, "SELECT " MODEL_COLUMNS " FROM models WHERE patient = ? AND id = ?");
  if (query.bind(patient, id).next()) return model_of(query);
  if (!query.status().ok()) return query.status();
  return no_model(patient, id);
}

absl::StatusOr<std::vector<ModelRecord>> SqliteStore::list_models(const std::string& patient, const Page& page) {
  const std::lock_guard lock(mutex_);
  if (const auto known = read_patient(patient); !known.ok()) return known.status();
  Query query(*database_, "SELECT " MODEL_COLUMNS " FROM models WHERE patient = ? AND id > ? ORDER BY id LIMIT ?");
  query.bind(patient, page.after, page.size);
  std::vector<ModelRecord> models;
  while (query.next()) models.push_back(model_of(query));
  if (!query.status().ok()) return query.status();
  return models;
}

absl::Status SqliteStore::delete_model(const std::string& patient, const std::string& id) {
  return transact([&]() -> absl::Status {
    const std::string name = model_name(patient, id);
    if (auto unused = check_unused(name, name + '\0'); !unused.ok()) return unused;
    Query remove(*database_, "DELETE FROM models WHERE patient = ? AND id = ?");
    const absl::Status removed = remove.bind(patient, id).run();
    if (removed.ok() && database_->changes() == 0) return no_model(patient, id);
    return removed.ok() ? forget_requests(name) : removed;
  });
}

}  // namespace lipofill::server
