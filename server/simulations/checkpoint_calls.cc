#include "server/simulations/checkpoint_calls.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "server/backend/await.h"
#include "server/backend/checkpoint_loading.h"
#include "server/backend/parking.h"
#include "server/backend/simulation_creation.h"
#include "server/entry/listing.h"
#include "server/sessions/identifiers.h"
#include "server/store/record_names.h"
#include "server/wire/names.h"
#include "server/wire/request_key.h"
#include "server/wire/timestamps.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// The id, in its new simulation, of the checkpoint that one began from.
constexpr char kOriginId[] = "origin";

struct RestoreTarget {
  CheckpointRecord checkpoint;
  SimulationRecord source;
  RequestKey key;
};

absl::StatusOr<RestoreTarget> find_target(Backend& backend, const Principal& caller,
                                          const v1::RestoreSimulationRequest& request) {
  FieldViolations violations;
  violations.absorb("", check_request_id(request.request_id()));
  violations.absorb("", check_display_name(request.display_name(), "display_name"));
  const auto parts = parse_checkpoint_name(request.checkpoint(), "checkpoint");
  violations.absorb("", parts.status());
  if (!request.as_new()) {
    if (!request.simulation_id().empty()) violations.add("simulation_id", "goes with as_new");
    if (!request.display_name().empty()) violations.add("display_name", "goes with as_new");
    if (request.start()) violations.add("start", "goes with as_new");
  }
  if (!violations.empty()) return violations.to_status();
  auto checkpoint = backend.store.get_checkpoint(parts->simulation, parts->id);
  if (!checkpoint.ok()) return checkpoint.status();
  auto source = backend.store.get_simulation(parts->simulation);
  if (!source.ok()) return source.status();
  return RestoreTarget{*std::move(checkpoint), *std::move(source),
                       make_request_key(caller, "RestoreSimulation", request.request_id(), request)};
}

absl::StatusOr<v1::Simulation> take_back(Backend& backend, const RestoreTarget& target) {
  const auto found = find_or_wake(backend, target.source.id);
  if (!found.ok()) return found.status();
  const auto& session = *found;
  if (session == nullptr) return no_session_for(backend, "restore", target.source);
  auto loaded = load_checkpoint(backend, target.checkpoint, target.source.model);
  if (!loaded.ok()) return loaded.status();
  const auto view = await<absl::StatusOr<SessionView>>([&](auto reply) {
    session->restore({target.checkpoint, std::move(loaded->simulation), loaded->content.spec_message}, target.key,
                     std::move(reply));
  });
  if (!view.ok()) return view.status();
  const auto record = backend.store.get_simulation(target.source.id);
  if (!record.ok()) return record.status();
  return to_simulation(*record, &*view);
}

/// The new simulation's own copy of the checkpoint, which it holds on to until it ends.
absl::StatusOr<CheckpointRecord> copy_checkpoint(Backend& backend, const LoadedCheckpoint& loaded,
                                                 CheckpointRecord record, const std::string& simulation) {
  if (auto room = backend.keeper.check_room(record.size_bytes); !room.ok()) return room;
  CheckpointContent content = loaded.content;
  content.simulation = simulation;
  const std::string path = checkpoint_path(simulation, kOriginId);
  if (absl::Status noted = backend.temporary_files.begin(path); !noted.ok()) return noted;
  const auto written = backend.checkpoint_files.write(simulation, kOriginId, content);
  if (!written.ok()) {
    backend.temporary_files.give_up(path);
    return written.status();
  }
  record.simulation = simulation;
  record.id = kOriginId;
  record.kind = CheckpointKind::kOrigin;
  record.size_bytes = written->size_bytes;
  record.sha256 = written->sha256;
  record.wall_s = 0.0;
  record.last_command = 0;
  record.create_time_us = now_us();
  return record;
}

/// The record of a simulation, and the checkpoint it begins from. Nobody else takes the name
/// meanwhile: the file would be another's.
absl::StatusOr<SimulationRecord> keep_with_origin(Backend& backend, const SimulationRecord& record,
                                                  const LoadedCheckpoint& loaded, const RestoreTarget& target) {
  const std::lock_guard lock(backend.waking);
  if (!absl::IsNotFound(backend.store.get_simulation(record.id).status())) {
    return absl::AlreadyExistsError(absl::StrCat(simulation_name(record.id), " exists"));
  }
  const auto copy = copy_checkpoint(backend, loaded, target.checkpoint, record.id);
  if (!copy.ok()) return copy.status();
  auto kept = backend.store.create_simulation_from(record, *copy, target.key);
  if (!kept.ok() || kept->id != record.id) {
    backend.temporary_files.give_up(checkpoint_path(record.id, kOriginId));
  }
  return kept;
}

absl::StatusOr<v1::Simulation> begin_from(Backend& backend, const RestoreTarget& target,
                                          const v1::RestoreSimulationRequest& request) {
  const auto id = id_or_new(request.simulation_id(), 'x', "simulation_id", target.source.tenant);
  if (!id.ok()) return id.status();
  if (backend.store.get_simulation(*id).ok()) {
    return absl::AlreadyExistsError(absl::StrCat(simulation_name(*id), " exists"));
  }
  auto place = backend.sessions.reserve(target.source.tenant);
  if (!place.ok()) return place.status();
  auto loaded = load_checkpoint(backend, target.checkpoint, target.source.model);
  if (!loaded.ok()) return loaded.status();
  if (absl::Status room = place->claim(loaded->simulation->memory_bytes()); !room.ok()) return room;
  SimulationRecord record;
  record.id = *id;
  record.model = target.source.model;
  record.display_name = request.display_name();
  record.spec_message = loaded->content.spec_message;
  record.create_time_us = now_us();
  record.origin = request.checkpoint();
  record.tenant = target.source.tenant;
  const auto kept = keep_with_origin(backend, record, *loaded, target);
  if (!kept.ok()) return kept.status();
  if (kept->id != *id) return show_made_before(backend, simulation_name(kept->id), request.start());
  const auto epoch = static_cast<uint64_t>(record.create_time_us);
  auto session = std::make_shared<Session>(make_session_options(backend, record, epoch, loaded->spec),
                                           std::move(loaded->simulation), backend.workers, backend.keeper);
  return open_session(backend, *std::move(place), record, std::move(session), request.start());
}

}  // namespace

v1::Checkpoint to_checkpoint(const CheckpointRecord& record) {
  v1::Checkpoint checkpoint;
  checkpoint.set_name(checkpoint_name(record.simulation, record.id));
  *checkpoint.mutable_create_time() = to_timestamp(record.create_time_us);
  checkpoint.set_step(record.step);
  checkpoint.set_time_s(record.time_s);
  checkpoint.set_state_hash(record.state_hash);
  checkpoint.set_size_bytes(record.size_bytes);
  checkpoint.set_sha256(record.sha256);
  checkpoint.set_automatic(record.kind == CheckpointKind::kAutomatic);
  checkpoint.set_on_course(record.on_course);
  return checkpoint;
}

absl::StatusOr<v1::Checkpoint> create_checkpoint(Backend& backend, const Principal& caller,
                                                 const v1::CreateCheckpointRequest& request) {
  FieldViolations violations;
  const auto simulation = parse_simulation_name(request.parent(), "parent");
  violations.absorb("", simulation.status());
  violations.absorb("", check_request_id(request.request_id()));
  const auto id = id_or_new(request.checkpoint_id(), 'c', "checkpoint_id");
  violations.absorb("", id.status());
  if (!violations.empty()) return violations.to_status();
  const RequestKey key = make_request_key(caller, "CreateCheckpoint", request.request_id(), request);
  const auto earlier = backend.store.find_request(key);
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) {
    const auto made = parse_checkpoint_name(**earlier, "name");
    if (!made.ok()) return made.status();
    const auto record = backend.store.get_checkpoint(made->simulation, made->id);
    if (!record.ok()) return record.status();
    return to_checkpoint(*record);
  }
  const auto found = find_or_wake(backend, *simulation);
  if (!found.ok()) return found.status();
  const auto& session = *found;
  if (session == nullptr) {
    const auto record = backend.store.get_simulation(*simulation);
    return record.ok() ? no_session_for(backend, "checkpoint", *record) : record.status();
  }
  const auto record =
      await<absl::StatusOr<CheckpointRecord>>([&](auto reply) { session->checkpoint(*id, key, std::move(reply)); });
  if (!record.ok()) return record.status();
  return to_checkpoint(*record);
}

absl::StatusOr<v1::Simulation> restore_simulation(Backend& backend, const Principal& caller,
                                                  const v1::RestoreSimulationRequest& request) {
  const RequestKey key = make_request_key(caller, "RestoreSimulation", request.request_id(), request);
  const auto earlier = backend.store.find_request(key);
  if (!earlier.ok()) return earlier.status();
  if (earlier->has_value()) return show_made_before(backend, **earlier, request.start());
  const auto target = find_target(backend, caller, request);
  if (!target.ok()) return target.status();
  return request.as_new() ? begin_from(backend, *target, request) : take_back(backend, *target);
}

absl::Status get_checkpoint(Backend& backend, const v1::GetCheckpointRequest& request, v1::Checkpoint& response) {
  const auto parts = parse_checkpoint_name(request.name(), "name");
  if (!parts.ok()) return parts.status();
  const auto record = backend.store.get_checkpoint(parts->simulation, parts->id);
  if (record.ok()) response = to_checkpoint(*record);
  return record.status();
}

absl::Status list_checkpoints(Backend& backend, const v1::ListCheckpointsRequest& request,
                              v1::ListCheckpointsResponse& response) {
  const auto id = parse_simulation_name(request.parent(), "parent");
  if (!id.ok()) return id.status();
  const std::string collection = request.parent() + "/checkpoints";
  const auto page = parse_page(collection, request.page_size(), request.page_token());
  if (!page.ok()) return page.status();
  const auto records = backend.store.list_checkpoints(*id, one_more(*page));
  if (!records.ok()) return records.status();
  response.set_next_page_token(fill_page(collection, *page, *records, [&](const CheckpointRecord& record) {
    if (record.is_damaged) return add_unreachable(checkpoint_name(record.simulation, record.id), response);
    *response.add_checkpoints() = to_checkpoint(record);
  }));
  return absl::OkStatus();
}

absl::Status delete_checkpoint(Backend& backend, const v1::DeleteCheckpointRequest& request) {
  const auto parts = parse_checkpoint_name(request.name(), "name");
  if (!parts.ok()) return parts.status();
  const absl::Status done =
      backend.reserve.spend([&] { return backend.store.delete_checkpoint(parts->simulation, parts->id); });
  if (done.ok()) backend.temporary_files.remove_deleted();
  return done;
}

}  // namespace lipofill::server
