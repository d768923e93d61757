#include "server/backend/checkpoint_loading.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/backend/simulation_creation.h"
#include "server/store/record_names.h"
#include "server/wire/names.h"

namespace lipofill::server {
namespace {

absl::Status damaged(const CheckpointRecord& record, const absl::Status& why) {
  return absl::Status(why.code(), absl::StrCat(checkpoint_name(record.simulation, record.id),
                                               " cannot be used: ", std::string(why.message())));
}

}  // namespace

absl::StatusOr<LoadedCheckpoint> load_checkpoint(Backend& backend, const CheckpointRecord& record,
                                                 const std::string& model) {
  LoadedCheckpoint loaded;
  auto content = backend.checkpoint_files.read(record.simulation, record.id, record.sha256);
  if (!content.ok()) return damaged(record, content.status());
  loaded.content = *std::move(content);
  if (!loaded.spec.ParseFromString(loaded.content.spec_message)) {
    return damaged(record, absl::DataLossError("its plan cannot be read"));
  }
  auto simulation = make_simulation(backend, model, loaded.spec);
  if (!simulation.ok()) return simulation.status();
  loaded.simulation = *std::move(simulation);
  if (auto restored = loaded.simulation->restore(loaded.content.snapshot); !restored.ok()) {
    return damaged(record, restored);
  }
  return loaded;
}

}  // namespace lipofill::server
