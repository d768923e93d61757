#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/simulation/preview.h"
#include "core/simulation/simulation.h"
#include "server/sessions/frame.h"
#include "server/sessions/viewer.h"
#include "server/sessions/worker_pool.h"
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
  simulation::StepReport report;
  std::vector<simulation::ZoneReport> zones;
  std::vector<simulation::LigamentReport> ligaments;
  int n_hexahedra = 0;
  int n_film_cells = 0;
  int n_dofs = 0;
  double wall_s = 0.0;          ///< spent RUNNING, but for the preview
  double step_ms_median = 0.0;  ///< computing time of a step
  std::string state_hash;       ///< empty in a cached view of a live simulation
  std::optional<PreviewView> preview;
};

class Session;

/// Where a session leaves what must last. Called on whichever thread runs the session, between steps.
class SessionSink {
 public:
  virtual ~SessionSink() = default;
  virtual absl::Status append_series(const std::string& id, const std::vector<SeriesEntry>& rows) = 0;
  /// After this succeeds the session can be forgotten: the store knows all of it.
  virtual absl::Status ended(const std::string& id, const SessionView& view, const Topology& topology,
                             const Frame& frame) = 0;
};

struct SessionOptions {
  std::string id;
  uint64_t epoch = 0;
  bool real_time = false;  ///< at most one simulated second a second
  bool preview = false;    ///< a coarse model's settled shape first
};

/// A simulation that lives in the daemon, not in a connection: steps on the worker pool while RUNNING, takes commands
/// between steps, and shows its frames to viewers. The results depend on the plan and on the steps between which
/// commands took effect, never on workers, viewers or the clock.
///
/// One lock (`execution_`) is held by whoever acts on the simulation. Commands go through a mailbox; they are carried
/// out at once when the simulation is at rest between turns, otherwise by the worker after the step at hand. Checked by
/// tests/unit/server/session_test.cc and tests/integration/service/.
class Session : public WorkerPool::Task, public std::enable_shared_from_this<Session> {
 public:
  using Reply = std::function<void(absl::StatusOr<SessionView>)>;

  Session(SessionOptions options, std::unique_ptr<simulation::Simulation> simulation, WorkerPool& workers,
          SessionSink& sink);

  const std::string& id() const { return options_.id; }

  /// Commands. The reply comes within one step, on any thread: FAILED_PRECONDITION naming the state where it does not
  /// fit.
  void start(Reply reply);
  void pause(Reply reply);
  void resume(Reply reply);
  void stop(std::string reason, Reply reply);
  void inject(simulation::InjectionSpec injection, Reply reply);
  /// The figures as they are now, with the state hash.
  void inspect(Reply reply);

  /// Shows the meshes and the present frame to the viewer, then every frame it wants, until unwatch() or the end.
  void watch(std::shared_ptr<Viewer> viewer);
  void unwatch(std::shared_ptr<Viewer> viewer);
  /// Meshes and present fields of them (the last ones when it has ended).
  using CaptureReply = std::function<void(std::shared_ptr<const Topology>, std::shared_ptr<const Frame>)>;
  void capture(std::vector<std::string> meshes, CaptureReply reply);
  /// Ends all viewers' streams, for the end of the daemon.
  void close_viewers(absl::Status status);

  /// Figures after the last step, without waiting for the one at hand.
  SessionView cached_view() const;
  /// Rows after `after_step` that are not in the sink yet.
  std::vector<SeriesEntry> pending_series(uint64_t after_step) const;

  WorkerPool::Next take_turn() override;

 private:
  using Command = std::function<void()>;
  using Clock = WorkerPool::Clock;

  void post(Command command);
  void carry_out_when_idle();
  bool mailbox_empty() const;

  // All below: with `execution_` held.
  void carry_out_commands();
  void answer(const Reply& reply, const std::function<absl::Status()>& act);
  void command(const char* what, std::initializer_list<SimulationState> allowed, const Reply& reply,
               const std::function<absl::Status()>& act);
  void run();
  WorkerPool::Next advance_slice();
  void advance_one_step();
  void record_step(double wall_ms);
  void flush_series();
  void set_state(SimulationState state, std::string reason);
  void finish(SimulationState state, const std::string& reason);
  void conclude();
  void leave_running();
  void update_view();
  SessionView full_view();
  std::shared_ptr<const Topology> topology();
  std::shared_ptr<const Frame> make_frame(const std::vector<std::string>& meshes, bool end);
  void show_to_viewers(bool at_rest);
  Clock::time_point due_time() const;
  bool preview_is_due() const;
  void advance_preview();
  void advance_preview(PreviewView& view);
  std::shared_ptr<const Frame> make_preview_frame() const;
  void conclude_preview();
  void note_changed_plan();
  void judge_preview();
  void note_preview(const PreviewView& preview);

  const SessionOptions options_;
  WorkerPool& workers_;
  SessionSink& sink_;

  mutable std::mutex mailbox_mutex_;
  std::deque<Command> mailbox_;

  std::mutex execution_;
  std::unique_ptr<simulation::Simulation> simulation_;  ///< gone once ended
  bool scheduled_ = false;                              ///< the pool has it
  std::vector<float> step_ms_;
  Clock::time_point running_since_;
  double running_since_time_s_ = 0.0;  ///< simulated
  double wall_before_s_ = 0.0;
  std::vector<std::shared_ptr<Viewer>> viewers_;
  std::shared_ptr<const Topology> topology_;
  std::shared_ptr<const Frame> last_frame_;       ///< once ended
  std::unique_ptr<simulation::Preview> preview_;  ///< under way
  std::shared_ptr<const Frame> preview_frame_;    ///< once it is done

  mutable std::mutex view_mutex_;
  SessionView view_;
  std::vector<SeriesEntry> pending_;
};

}  // namespace lipofill::server
