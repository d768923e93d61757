#include "server/backend/result_keeper.h"

#include <algorithm>
#include <chrono>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/sessions/identifiers.h"
#include "server/store/ownership.h"
#include "server/store/record_names.h"
#include "server/wire/frame_encoding.h"
#include "server/wire/report_conversion.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

SeriesChunk to_chunk(const std::vector<SeriesEntry>& rows) {
  v1::GetSeriesResponse message;
  for (const SeriesEntry& row : rows) *message.add_rows() = to_series_row(row);
  return {rows.front().report.step, rows.back().report.step, message.SerializeAsString()};
}

}  // namespace

absl::StatusOr<bool> ResultKeeper::was_kept(const RequestKey& request) {
  const auto earlier = store_.find_request(request);
  if (!earlier.ok()) return earlier.status();
  return earlier->has_value();
}

absl::StatusOr<bool> ResultKeeper::keep_command(const CommandRecord& command, const RequestKey& request) {
  return store_.append_command(command, "", request);
}

// The plan that is kept follows what was injected. Others cannot do the same meanwhile: the session
// is locked.
absl::StatusOr<bool> ResultKeeper::keep_injection(const CommandRecord& command, double start_s,
                                                  const RequestKey& request) {
  v1::Injection injection;
  if (!injection.ParseFromString(command.payload)) return absl::InternalError("the injection cannot be read");
  injection.set_start_s(start_s);
  const auto record = store_.get_simulation(command.simulation);
  if (!record.ok()) return record.status();
  v1::SimulationSpec spec;
  if (!spec.ParseFromString(record->spec_message)) return absl::DataLossError("the plan cannot be read");
  *spec.add_injections() = injection;
  CommandRecord resolved = command;
  resolved.payload = injection.SerializeAsString();
  return store_.append_command(resolved, spec.SerializeAsString(), request);
}

absl::StatusOr<bool> ResultKeeper::keep_restore(const CommandRecord& command, SimulationState state,
                                                const std::string& spec_message, const RequestKey& request) {
  auto kept = store_.restore_simulation(command, state, spec_message, request);
  if (kept.ok() && *kept) {
    // Automatic checkpoints that were left off course are of no use.
    store_.prune_checkpoints(command.simulation, options_.kept).IgnoreError();
    temporary_.remove_deleted();
  }
  return kept;
}

absl::StatusOr<uint64_t> ResultKeeper::begin_epoch(const std::string& id) {
  return store_.begin_epoch(id, now_us());
}

absl::StatusOr<CheckpointRecord> ResultKeeper::keep_checkpoint(const CheckpointRecord& draft,
                                                               const std::string& snapshot,
                                                               const std::vector<SeriesEntry>& rows,
                                                               const RequestKey& request) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point began = Clock::now();
  auto written = write_checkpoint(draft, snapshot, rows, request);
  if (written.ok()) {
    metrics_.simulations().count_checkpoint(std::chrono::duration<double>(Clock::now() - began).count(),
                                            written->size_bytes);
  } else {
    metrics_.simulations().count_failed_checkpoint();
  }
  return written;
}

// The file first: a record whose file is not there is never seen. It is noted before that: a file
// that never gets its record is swept.
absl::StatusOr<CheckpointRecord> ResultKeeper::write_checkpoint(const CheckpointRecord& draft,
                                                                const std::string& snapshot,
                                                                const std::vector<SeriesEntry>& rows,
                                                                const RequestKey& request) {
  const auto simulation = store_.get_simulation(draft.simulation);
  if (!simulation.ok()) return simulation.status();
  if (!absl::IsNotFound(store_.get_checkpoint(draft.simulation, draft.id).status())) {
    return absl::AlreadyExistsError(absl::StrCat(checkpoint_name(draft.simulation, draft.id), " exists"));
  }
  if (draft.kind == CheckpointKind::kAsked) {
    if (auto few = check_number_asked(draft.simulation); !few.ok()) return few;
  }
  const uint64_t bytes = snapshot.size() + simulation->spec_message.size();
  absl::Status room = check_room(bytes);
  if (!room.ok() && draft.kind == CheckpointKind::kAutomatic) {
    // One checkpoint is better than none: it takes the place of the older ones.
    store_.prune_checkpoints(draft.simulation, 1).IgnoreError();
    temporary_.remove_deleted();
    room = check_room(bytes);
  }
  if (!room.ok()) return room;
  const auto plan = plan_as_of(*simulation, draft.last_command);
  if (!plan.ok()) return plan.status();
  const std::string path = checkpoint_path(draft.simulation, draft.id);
  if (absl::Status noted = temporary_.begin(path); !noted.ok()) return noted;
  auto kept = write_noted(draft, *plan, snapshot, rows, request);
  if (!kept.ok()) {
    temporary_.give_up(path);
  } else if (store_.prune_checkpoints(draft.simulation, options_.kept).ok()) {
    temporary_.remove_deleted();
  }
  return kept;
}

absl::StatusOr<CheckpointRecord> ResultKeeper::write_noted(const CheckpointRecord& draft,
                                                           const std::string& spec_message, const std::string& snapshot,
                                                           const std::vector<SeriesEntry>& rows,
                                                           const RequestKey& request) {
  const auto written = files_.write(draft.simulation, draft.id, {draft.simulation, draft.step, spec_message, snapshot});
  if (!written.ok()) return written.status();
  CheckpointRecord record = draft;
  record.size_bytes = written->size_bytes;
  record.sha256 = written->sha256;
  std::optional<SeriesChunk> chunk;
  if (!rows.empty()) chunk = to_chunk(rows);
  return store_.create_checkpoint(record, chunk, request);
}

/// The plan without the injections that came after a command: a simulation that catches up has yet
/// to take them. With 0 the plan as it is.
absl::StatusOr<std::string> ResultKeeper::plan_as_of(const SimulationRecord& simulation, uint64_t last_command) const {
  if (last_command == 0) return simulation.spec_message;
  const auto commands = store_.list_commands(simulation.id);
  if (!commands.ok()) return commands.status();
  const auto later = std::count_if(commands->begin(), commands->end(), [last_command](const CommandRecord& command) {
    return command.kind == CommandKind::kInject && command.number > last_command;
  });
  v1::SimulationSpec spec;
  if (!spec.ParseFromString(simulation.spec_message) || spec.injections_size() < later) {
    return absl::DataLossError("the plan does not go with its log");
  }
  spec.mutable_injections()->DeleteSubrange(spec.injections_size() - static_cast<int>(later), static_cast<int>(later));
  return spec.SerializeAsString();
}

absl::Status ResultKeeper::check_number_asked(const std::string& simulation) const {
  const auto all = store_.list_checkpoints(simulation, {"", options_.most_asked + options_.kept + 2});
  if (!all.ok()) return all.status();
  const auto asked = std::count_if(all->begin(), all->end(),
                                   [](const CheckpointRecord& c) { return c.kind == CheckpointKind::kAsked; });
  if (asked < options_.most_asked) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat(simulation_name(simulation), " has ", asked,
                                                   " checkpoints made by clients, the bound is ", options_.most_asked,
                                                   "; delete one"));
}

absl::Status ResultKeeper::check_room(uint64_t bytes) const {
  const auto used = store_.count_checkpoint_bytes();
  if (!used.ok()) return used.status();
  if (*used + bytes <= options_.most_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("checkpoints take ", *used, " bytes, with ", bytes,
                                                   " more they would be over the bound of ", options_.most_bytes,
                                                   "; delete some"));
}

absl::Status ResultKeeper::append_series(const std::string& id, const std::vector<SeriesEntry>& rows) {
  return store_.append_series(id, to_chunk(rows));
}

void ResultKeeper::stepped(const SeriesEntry& entry) {
  const mechanics::StepCost& cost = entry.report.cost;
  StepFigures step;
  step.wall_s = kSecondsPerMillisecond * entry.wall_ms;
  step.cpu_s = cost.times.total;
  step.element_cpu_s = cost.times.element;
  step.factor_cpu_s = cost.times.factor;
  step.solve_cpu_s = cost.times.solve;
  step.film_cpu_s = cost.times.film;
  step.coupling_cpu_s = cost.times.coupling;
  step.film_iterations = cost.film_iterations;
  step.newton_iterations = cost.newton_iterations;
  step.iterative_iterations = cost.iterative_iterations;
  step.factorisations = cost.factorisations;
  step.tissue_solves = cost.tissue_solves;
  step.fallbacks = cost.fallbacks;
  metrics_.steps().count(step);
}

// Whoever is asked for it next takes it, also this daemon, in another epoch.
absl::Status ResultKeeper::parked(const std::string& id, const SessionView& view) {
  Ownership* const ownership = ownership_of(store_);
  const auto epoch = ownership != nullptr ? ownership->tenures()->epoch_of(id) : std::nullopt;
  const absl::Status kept = store_.keep_summary(id, to_summary(view).SerializeAsString());
  if (!kept.ok()) return kept;
  if (!sessions_.remove_unless_held(id)) {
    store_.keep_summary(id, "").IgnoreError();
    return absl::AbortedError("the simulation is in use at this moment");
  }
  if (epoch) ownership->give_back(id, *epoch);
  metrics_.simulations().count_parked();
  return kept;
}

absl::Status ResultKeeper::ended(const std::string& id, const SessionView& view, const Topology& topology,
                                 const Frame& frame) {
  std::vector<std::string> meshes;
  for (const auto& mesh : topology.meshes) meshes.push_back(mesh.name);
  SimulationRecord record;
  record.id = id;
  record.state = view.state;
  record.reason = view.reason;
  record.summary_message = to_summary(view).SerializeAsString();
  const SimulationResult result{to_whole_meshes(topology, meshes).SerializeAsString(),
                                to_whole_frame(frame, {meshes}).SerializeAsString()};
  const absl::Status kept = store_.end_simulation(record, result);
  if (!kept.ok()) return kept;
  temporary_.remove_deleted();
  sessions_.remove(id);
  metrics_.simulations().count_ended(state_name(view.state));
  return kept;
}

}  // namespace lipofill::server
