#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/simulation/simulation.h"
#include "server/sessions/audience.h"
#include "server/sessions/frame.h"
#include "server/sessions/pending_series.h"
#include "server/sessions/preview_run.h"
#include "server/sessions/run_clock.h"
#include "server/sessions/session_figures.h"
#include "server/sessions/session_options.h"
#include "server/sessions/session_sink.h"

namespace lipofill::server {

/// A simulation with what goes along with its steps: its figures, the rows of its series, its
/// preview, and its frames to viewers. It does what it is told; when steps are taken and commands
/// fit is decided above (simulation_run.h, session.h). For one thread at a time, but for figures()
/// and series(), which any thread may read.
///
/// Checked by tests/unit/server/sessions/live_simulation_test.cc and the tests of sessions.
class LiveSimulation {
 public:
  using CaptureReply = std::function<void(std::shared_ptr<const Topology>, std::shared_ptr<const Frame>)>;

  /// @param wall_s  what it has run before [s]
  LiveSimulation(const SessionOptions& options, std::unique_ptr<simulation::Simulation> simulation,
                 SimulationState state, double wall_s, SessionSink& sink);

  const SessionFigures& figures() const { return figures_; }
  const PendingSeries& series() const { return series_; }

  /// The simulation; null once it has ended or was let go of.
  simulation::Simulation* simulation() const { return simulation_.get(); }
  RunClock& clock() { return clock_; }
  void set_state(SimulationState state, std::string reason);
  void set_catching_up(std::optional<uint64_t> until_step) { figures_.set_catching_up(until_step); }
  void set_reason(std::string reason) { figures_.set_reason(std::move(reason)); }
  /// The figures as they are now, with the state hash.
  SessionView measure();

  bool preview_is_due() const { return preview_.is_due(); }
  /// Takes a step of the preview. The clock of the simulation stands meanwhile.
  void advance_preview();
  /// Takes a step, and shows it unless it was the last.
  void advance_step();

  void inject(const simulation::ResolvedInjection& injection);
  /// Goes on with another simulation of the plan, in a new epoch.
  void go_back(std::unique_ptr<simulation::Simulation> simulation, double wall_s);
  /// Has the sink keep the present state, and with it the rows that are not there yet.
  /// `last_command` is the number of the last command in it; 0: all that the sink has.
  absl::StatusOr<CheckpointRecord> keep_checkpoint(CheckpointKind kind, const std::string& id, uint64_t last_command,
                                                   const RequestKey& request);

  bool is_watched() const { return !audience_.empty(); }
  /// Shows the meshes and the present frame, then every frame that the viewer wants.
  void watch(const std::shared_ptr<Viewer>& viewer);
  void unwatch(const std::shared_ptr<Viewer>& viewer) { audience_.leave(viewer); }
  void close_viewers(const absl::Status& status) { audience_.close(status); }
  void capture(const std::vector<std::string>& meshes, const CaptureReply& reply);
  /// Shows viewers the state in which it rests.
  void show_at_rest() { show(true); }

  /// Makes the result of a simulation that has ended, has the sink keep it, and shows the last
  /// frame.
  void conclude();
  /// The same for one of which no result is to be kept.
  void conclude_unkept();
  bool result_is_kept() const { return result_kept_; }
  absl::Status keep_result();
  /// Nothing of it is to be kept any more.
  void forget_result() { result_kept_ = true; }
  /// Has the sink keep the figures of one that is to be parked, and shows them from now on.
  absl::Status keep_parked();
  /// Releases everything that only a simulation that has not ended needs. Its figures stay.
  void let_go();

 private:
  void show(bool at_rest);
  bool has_frames() const { return simulation_ != nullptr || last_frame_ != nullptr; }
  std::shared_ptr<const Topology> topology();
  std::shared_ptr<const Frame> make_frame(const std::vector<std::string>& meshes, bool end) const;
  /// The last frame once it has ended, until then one of the present state.
  std::shared_ptr<const Frame> present_frame(const std::vector<std::string>& meshes) const;
  void note_changed_plan(const std::string& why);
  void take_last_frame();

  const std::string id_;
  SessionSink& sink_;
  std::unique_ptr<simulation::Simulation> simulation_;
  uint64_t epoch_;
  RunClock clock_;
  PreviewRun preview_;
  SessionFigures figures_;
  PendingSeries series_;
  Audience audience_;
  std::shared_ptr<const Topology> topology_;
  std::shared_ptr<const Frame> last_frame_;  ///< once it has ended
  bool result_kept_ = false;
};

}  // namespace lipofill::server
