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
#include "core/simulation/simulation.h"
#include "server/sessions/frame.h"
#include "server/sessions/session_sink.h"
#include "server/sessions/viewer.h"
#include "server/sessions/worker_pool.h"
#include "server/store/records.h"

namespace lipofill::server {

struct SessionOptions {
  std::string id;
  std::string tenant = {};  ///< whose simulations share the workers as one
  uint64_t epoch = 0;
  bool real_time = false;              ///< at most one simulated second a second
  bool preview = false;                ///< a coarse model's settled shape first
  double checkpoint_interval_s = 0.0;  ///< wall time RUNNING between automatic checkpoints; 0: none
};

/// An injection as the core takes it and as the sink keeps it.
struct InjectionOrder {
  plan::InjectionSpec spec;
  std::string message;
  std::function<absl::Status()> check = nullptr;  ///< may refuse it; no command comes between it and the injection
};

/// A state to go back to: a simulation that is in it, and the plan that goes with it.
struct RestoreOrder {
  CheckpointRecord checkpoint;
  std::unique_ptr<simulation::Simulation> simulation;
  std::string spec_message;
};

/// The commands acknowledged before the daemon was started again that are not yet in the state the
/// session goes on from. They take effect after the same steps as the first time.
struct SessionHistory {
  SimulationState state = SimulationState::kReady;
  double wall_s = 0.0;  ///< spent RUNNING
  struct Injection {
    uint64_t step = 0;
    plan::InjectionSpec spec;
  };
  std::deque<Injection> injections;
  uint64_t until_step = 0;  ///< where the last command took effect
  std::optional<std::string> stop_reason;
  std::string note;  ///< what was not as it should be
};

/// A simulation that lives in the daemon, not in a connection: steps on the worker pool while RUNNING, takes commands
/// between steps, and shows its frames to viewers. The results depend on the plan and on the steps between which
/// commands took effect, never on workers, viewers, the clock, or on how often the daemon was started again.
///
/// A command is in the sink before it takes effect, and takes effect before it is answered: whatever was answered is
/// there after the end of the daemon, however that came. A session that is brought back first catches up: it repeats
/// what was acknowledged from its state on; commands that come meanwhile wait until that is done.
///
/// One lock (`execution_`) is held by whoever acts on the simulation. Commands go through a mailbox; they are carried
/// out at once when the simulation is at rest between turns, otherwise by the worker after the step at hand. Checked by
/// tests/unit/server/sessions/session_test.cc, tests/unit/server/sessions/session_resume_test.cc and
/// tests/integration/.
class Session : public WorkerPool::Task, public std::enable_shared_from_this<Session> {
 public:
  using Clock = WorkerPool::Clock;
  using Reply = std::function<void(absl::StatusOr<SessionView>)>;

  Session(SessionOptions options, std::unique_ptr<simulation::Simulation> simulation, WorkerPool& workers,
          SessionSink& sink, SessionHistory history = {});

  const std::string& id() const { return options_.id; }

  /// Lets a session that was brought back go on. It is called once, when others can find the
  /// session.
  void go_on();

  /// Commands. The reply comes within one step, on any thread: FAILED_PRECONDITION naming the state where it does not
  /// fit, what the sink says where it cannot be kept. A request that was carried out before is answered and no more.
  void start(RequestKey request, Reply reply);
  void pause(RequestKey request, Reply reply);
  void resume(RequestKey request, Reply reply);
  void stop(std::string reason, RequestKey request, Reply reply);
  void inject(InjectionOrder order, RequestKey request, Reply reply);
  /// Returns the injection that inject() would add, or the reason why it would not.
  using InjectionReply = std::function<void(absl::StatusOr<plan::InjectionSpec>)>;
  void foresee(InjectionOrder order, InjectionReply reply);
  void restore(RestoreOrder order, RequestKey request, Reply reply);
  /// The figures as they are now, with the state hash.
  void inspect(Reply reply);
  /// Ends it without a result once `forget` has deleted what is kept of it.
  void abandon(std::function<absl::Status()> forget, Reply reply);

  /// Keeps the present state under an id.
  using CheckpointReply = std::function<void(absl::StatusOr<CheckpointRecord>)>;
  void checkpoint(std::string checkpoint, RequestKey request, CheckpointReply reply);
  /// Keeps the present state, unless it is kept already or can be had at no cost.
  using Done = std::function<void(absl::Status)>;
  void save(Done done);
  /// Suspends the session when the daemon ends: it keeps its state and takes no step and no command
  /// any more.
  void suspend(Done done);

  /// Time since anything but figures was asked of it; 0 while it runs, is watched, is held or
  /// catches up. Does not wait.
  Clock::duration idle_time() const;
  /// True when it is held by hold(), or by a command that waits for its turn.
  bool is_held() const { return holders_ > 0 || !mailbox_empty(); }
  /// Parks the session if it still is idle for so long: keeps its state and figures, after which it
  /// answers nothing any more but that it is parked.
  void park(std::chrono::duration<double> idle);

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
  friend class HeldSession;
  using Command = std::function<void()>;

  void post(Command command);
  void queue(Command command);
  void carry_out_when_idle();
  bool mailbox_empty() const;

  // Everything below needs `execution_` held.
  void carry_out_commands();
  absl::Status guarded(const std::function<absl::Status()>& act);
  void answer(const Reply& reply, const std::function<absl::Status()>& act);
  void command(const char* what, std::vector<SimulationState> allowed, const RequestKey& request, const Reply& reply,
               const std::function<absl::Status()>& act);
  absl::StatusOr<plan::InjectionSpec> resolve(const InjectionOrder& order) const;
  absl::Status check_allowed(const char* what, const std::vector<SimulationState>& allowed) const;
  absl::Status keep_and_do(CommandKind kind, const std::string& payload, const RequestKey& request,
                           const std::function<void()>& act);
  CommandRecord record_of(CommandKind kind, const std::string& payload) const;

  void run();
  void schedule();
  bool takes_steps() const;
  WorkerPool::Next advance_slice();
  void advance_one_step();
  void record_step(double wall_ms);
  absl::Status flush_series();
  void forget_pending(size_t n_rows);
  void set_state(SimulationState state, std::string reason);
  void set_reason(std::string reason);
  void finish(SimulationState state, const std::string& reason);
  void conclude();
  void let_go();
  absl::Status keep_result();
  void begin_clock();
  void stop_clock();
  void leave_running();

  void catch_up();
  void end_catching_up();
  std::string catching_up_text() const;

  absl::StatusOr<CheckpointRecord> keep_checkpoint(CheckpointKind kind, const std::string& id,
                                                   const RequestKey& request);
  void checkpoint_when_due();
  void checkpoint_automatically();
  absl::Status save_now();
  bool can_be_parked(Clock::duration idle) const;
  absl::Status go_back(RestoreOrder& order, const RequestKey& request);

  void update_view();
  void show_figures(SessionView view);
  SessionView full_view();
  std::shared_ptr<const Topology> topology();
  std::shared_ptr<const Frame> make_frame(const std::vector<std::string>& meshes, bool end);
  void share_rate();
  void show_to_viewers(bool at_rest);
  void show_again_from_here();
  Clock::time_point due_time() const;
  bool preview_is_due() const;
  void advance_preview();
  void advance_preview(PreviewView& view);
  std::shared_ptr<const Frame> make_preview_frame() const;
  void conclude_preview();
  /// @param why  a preview that was shown is not of the plan any more
  void note_changed_plan(const std::string& why);
  void judge_preview();
  void note_preview(const PreviewView& preview);

  const SessionOptions options_;
  WorkerPool& workers_;
  SessionSink& sink_;

  mutable std::mutex mailbox_mutex_;
  std::deque<Command> mailbox_;

  std::mutex execution_;
  std::unique_ptr<simulation::Simulation> simulation_;  ///< gone once ended
  uint64_t epoch_;
  bool scheduled_ = false;  ///< the pool has it
  bool suspended_ = false;
  bool parked_ = false;
  bool result_kept_ = false;
  SessionHistory history_;
  bool catching_up_ = false;
  std::deque<Command> held_;  ///< until it has caught up
  Clock::time_point checkpoint_due_;
  std::optional<uint64_t> saved_step_;  ///< step of the last checkpoint
  std::vector<float> step_ms_;
  mechanics::CostSum cost_;
  bool clock_runs_ = false;
  Clock::time_point running_since_;
  double running_since_time_s_ = 0.0;  ///< simulated
  double wall_before_s_ = 0.0;
  std::vector<std::shared_ptr<Viewer>> viewers_;
  std::shared_ptr<const Topology> topology_;
  std::shared_ptr<const Frame> last_frame_;       ///< once ended
  std::unique_ptr<simulation::Preview> preview_;  ///< under way
  std::shared_ptr<const Frame> preview_frame_;    ///< once it is done

  std::atomic<int> watching_ = 0;  ///< between watch() and unwatch()
  std::atomic<int> holders_ = 0;   ///< see hold()

  std::atomic<Clock::time_point> last_asked_ = Clock::now();

  mutable std::mutex view_mutex_;
  SessionView view_;
  std::vector<SeriesEntry> pending_;
};

/// The session, which is not parked as long as this is there: for whoever is about to ask something of it. Null for
/// null.
std::shared_ptr<Session> hold(const std::shared_ptr<Session>& session);

}  // namespace lipofill::server
