#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/simulation/discretisation.h"
#include "core/simulation/preview.h"
#include "core/simulation/simulation.h"
#include "server/sessions/frame.h"
#include "server/store/records.h"

namespace lipofill::server {

/// One line of the time series: the report of a step and what it cost.
struct SeriesEntry {
  simulation::StepReport report;
  double wall_ms = 0.0;
};

/// kOutdated: it was shown, then the plan changed.
enum class PreviewState { kPending, kRunning, kDone, kFailed, kOutdated };

inline const char* preview_state_name(PreviewState state) {
  constexpr const char* kNames[] = {"PENDING", "RUNNING", "DONE", "FAILED", "OUTDATED"};
  return kNames[static_cast<int>(state)];
}

/// The preview of a simulation.
struct PreviewView {
  PreviewState state = PreviewState::kPending;
  std::string reason;  ///< why it came to rest, failed or is outdated
  simulation::StepReport report;
  int n_hexahedra = 0;
  int n_film_cells = 0;
  double wall_s = 0.0;
  std::optional<simulation::PreviewDifference> difference;  ///< once the simulation has its result
};

/// A simulation as it is between two steps.
struct SessionView {
  SimulationState state = SimulationState::kReady;
  std::string reason;
  /// The reason why the result of one that has ended is not in the store yet; empty: it is.
  std::string unkept;
  simulation::StepReport report;
  std::vector<simulation::ZoneReport> zones;
  std::vector<simulation::LigamentReport> ligaments;
  std::vector<std::string> remarks;
  std::vector<simulation::LayerReport> layers;  ///< empty in a cached view of a live simulation
  int n_hexahedra = 0;
  int n_film_cells = 0;
  int n_dofs = 0;
  double wall_s = 0.0;          ///< spent RUNNING, but for the preview
  double step_ms_median = 0.0;  ///< computing time of a step
  mechanics::CostSum cost;      ///< of the steps taken in this daemon
  std::string state_hash;       ///< empty in a cached view of a live simulation
  size_t queue_position = 0;    ///< while it waits to run: 1 is the next
  std::optional<PreviewView> preview;
  /// Once it has settled; a status that says why nothing is known.
  std::optional<absl::StatusOr<simulation::DiscretisationError>> discretisation;
  int viewers = 0;
  std::optional<uint64_t> catching_up_to;  ///< step, while it repeats what it did before the daemon was started again
};

/// Durable storage of a session. It is called on whichever thread runs the session, between steps;
/// anything for which it returns OK is on the medium.
class SessionSink {
 public:
  virtual ~SessionSink() = default;

  /// True when an equal request was kept before. INVALID_ARGUMENT when its id stands for another
  /// one.
  virtual absl::StatusOr<bool> was_kept(const RequestKey& request) = 0;
  /// Keeps a command before it takes effect. False: an equal request was kept before, and this one
  /// is not.
  virtual absl::StatusOr<bool> keep_command(const CommandRecord& command, const RequestKey& request) = 0;
  /// The same for an injection, whose message is the payload, with the start that it was resolved
  /// to [s].
  virtual absl::StatusOr<bool> keep_injection(const CommandRecord& command, double start_s,
                                              const RequestKey& request) = 0;
  /// The same for going back to a checkpoint; `state` and `spec_message` are what the simulation
  /// goes on with.
  virtual absl::StatusOr<bool> keep_restore(const CommandRecord& command, SimulationState state,
                                            const std::string& spec_message, const RequestKey& request) = 0;
  /// A number for a new stream of frames, larger than any before.
  virtual absl::StatusOr<uint64_t> begin_epoch(const std::string& id) = 0;

  /// The state and the rows that are not in the sink yet, both or neither. Sizes and hash of the
  /// draft are filled in.
  virtual absl::StatusOr<CheckpointRecord> keep_checkpoint(const CheckpointRecord& draft, const std::string& snapshot,
                                                           const std::vector<SeriesEntry>& rows,
                                                           const RequestKey& request) = 0;
  virtual absl::Status append_series(const std::string& id, const std::vector<SeriesEntry>& rows) = 0;
  /// Is called after every step, for figures of the daemon; must not block.
  virtual void stepped(const SeriesEntry&) {}
  /// Parks a session at rest whose state was kept just before: after this succeeds the session can
  /// be forgotten, and another be made of what was kept. ABORTED when somebody holds it: it stays.
  virtual absl::Status parked(const std::string& id, const SessionView& view) = 0;
  /// Ends a session: after this succeeds it can be forgotten, as the store knows all of it.
  virtual absl::Status ended(const std::string& id, const SessionView& view, const Topology& topology,
                             const Frame& frame) = 0;
};

}  // namespace lipofill::server
