#include "absl/strings/str_cat.h"
#include "server/store/record_names.h"
#include "server/store/row_sums.h"
#include "server/store/sql_store.h"

namespace lipofill::server {
namespace {

ModelRecord model_of(const Query& row) {
  return {row.text(0), row.text(1), row.text(2), row.text(3), row.text(4), row.text(5), row.integer(6), row.text(7)};
}

/// A row of a list: one that is damaged is named and no more.
ModelRecord listed_model_of(const Query& row) {
  if (row.is_true(8)) return model_of(row);
  ModelRecord damaged;
  damaged.patient = row.text(0);
  damaged.id = row.text(1);
  damaged.is_damaged = true;
  return damaged;
}

absl::Status no_model(const std::string& patient, const std::string& id) {
  return absl::NotFoundError(absl::StrCat("there is no ", model_name(patient, id)));
}

}  // namespace

absl::StatusOr<ModelRecord> SqlStore::create_model(const ModelRecord& model, const RequestKey& request) {
  const auto earlier = transact_once(request, model_name(model.patient, model.id), [&] { return write_model(model); });
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return get_model(model.patient, (**earlier).substr(model_name(model.patient, "").size()));
  return model;
}

absl::Status SqlStore::write_model(const ModelRecord& model) {
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

absl::StatusOr<ModelRecord> SqlStore::get_model(const std::string& patient, const std::string& id) {
  return turns_.look([&] { return read_model(patient, id); });
}

absl::StatusOr<ModelRecord> SqlStore::read_model(const std::string& patient, const std::string& id) {
  Query query(*database_, "SELECT " MODEL_COLUMNS
                          ", " IS_WHOLE("models", MODEL_COLUMNS) " FROM models WHERE patient = ? AND id = ?");
  if (!query.bind(patient, id).next()) return query.status().ok() ? no_model(patient, id) : query.status();
  if (!query.is_true(8)) return damaged_record(model_name(patient, id));
  return model_of(query);
}

absl::StatusOr<std::vector<ModelRecord>> SqlStore::list_models(const std::string& patient, const Page& page) {
  return turns_.look([&]() -> absl::StatusOr<std::vector<ModelRecord>> {
    if (const auto known = read_patient(patient); !known.ok()) return known.status();
    Query query(*database_,
                "SELECT " MODEL_COLUMNS
                ", " IS_WHOLE("models", MODEL_COLUMNS) " FROM models WHERE patient = ? AND id > ? ORDER BY id LIMIT ?");
    query.bind(patient, page.after, page.size);
    std::vector<ModelRecord> models;
    while (query.next()) models.push_back(listed_model_of(query));
    if (!query.status().ok()) return query.status();
    return models;
  });
}

absl::Status SqlStore::delete_model(const std::string& patient, const std::string& id) {
  return turns_.transact([&]() -> absl::Status {
    const std::string name = model_name(patient, id);
    if (auto unused = check_unused(name, name + '\0'); !unused.ok()) return unused;
    Query remove(*database_, "DELETE FROM models WHERE patient = ? AND id = ?");
    const absl::Status removed = remove.bind(patient, id).run();
    if (removed.ok() && database_->changes() == 0) return no_model(patient, id);
    return removed.ok() ? forget_requests(name) : removed;
  });
}

}  // namespace lipofill::server
