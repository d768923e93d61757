#include "absl/strings/str_cat.h"
#include "server/backend/backend.h"
#include "server/backend/model_reading.h"
#include "server/store/ownership.h"
#include "server/wire/names.h"

namespace lipofill::server {
namespace {

absl::StatusOr<ModelCache::Model> rebuild(Backend& backend, const std::string& name) {
  const auto ids = parse_model_name(name, "model");
  if (!ids.ok()) return ids.status();
  const auto record = backend.store.get_model(ids->patient, ids->id);
  if (!record.ok()) return record.status();
  v1::ModelSpec message;
  if (!message.ParseFromString(record->spec_message)) {
    return absl::DataLossError(absl::StrCat("the specification of ", name, " cannot be read"));
  }
  auto spec = read_model_spec(backend, ids->patient, message);
  if (!spec.ok()) return spec.status();
  auto model = model::build_face_model(*spec, [](double, const char*) { return true; });
  if (!model.ok()) {
    return absl::DataLossError(absl::StrCat(name, " cannot be built again: ", std::string(model.status().message())));
  }
  if ((*model)->content_hash != record->content_hash) {
    return absl::DataLossError(absl::StrCat(name, " was ", record->content_hash, ", built again it is ",
                                            (*model)->content_hash, ": its scan or the program has changed"));
  }
  return *std::move(model);
}

}  // namespace

// Another daemon may have deleted it, and made another of its name.
absl::StatusOr<ModelCache::Model> Backend::load_model(const std::string& name) {
  const auto build = [this, &name] { return rebuild(*this, name); };
  auto model = models.get(name, build);
  if (!model.ok() || ownership_of(store) == nullptr) return model;
  const auto ids = parse_model_name(name, "model");
  if (!ids.ok()) return ids.status();
  const auto record = store.get_model(ids->patient, ids->id);
  if (record.ok() && record->content_hash == (*model)->content_hash) return model;
  models.remove(name);
  if (!record.ok()) return record.status();
  return models.get(name, build);
}

}  // namespace lipofill::server
