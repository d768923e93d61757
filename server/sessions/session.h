#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/simulation/simulation.h"
#include "server/sessions/idle_clock.h"
#include "server/sessions/mailbox.h"
#include "server/sessions/session_command.h"
#include "server/sessions/session_options.h"
#include "server/sessions/session_sink.h"
#include "server/sessions/simulation_run.h"
#include "server/sessions/viewer.h"
#include "server/sessions/worker_pool.h"
#include "server/store/records.h"

namespace lipofill::server {

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

/// A simulation that lives in the daemon, not in a connection: steps on the worker pool while
/// RUNNING, takes commands between steps, and shows its frames to viewers. The results depend on
/// the plan and on the steps between which commands took effect, never on workers, viewers, the
/// clock, or on how often the daemon was started again.
///
/// A command is in the sink before it takes effect, and takes effect before it is answered:
/// whatever was answered is there after the end of the daemon, however that came. A session that is
/// brought back first catches up: it repeats what was acknowledged from its state on; commands that
/// come meanwhile wait until that is done.
///
/// Its way is: mailbox (Mailbox), which lets one thread at a time act on the simulation, at once
/// when that is at rest between turns, otherwise the worker after the step at hand; then receive(),
/// which checks that it fits; then the sink; then the simulation's run (SimulationRun), which the
/// next step is part of; then the answer.
///
/// Checked by tests/unit/server/sessions/session_test.cc,
/// tests/unit/server/sessions/session_resume_test.cc and tests/integration/.
class Session : public WorkerPool::Task, public std::enable_shared_from_this<Session> {
 public:
  using Clock = WorkerPool::Clock;
  using Reply = SessionReply;

  Session(SessionOptions options, std::unique_ptr<simulation::Simulation> simulation, WorkerPool& workers,
          SessionSink& sink, SessionHistory history = {});

  const std::string& id() const { return options_.id; }

  /// Lets a session that was brought back go on. It is called once, when others can find the
  /// session.
  void go_on();

  /// Commands. The reply comes within one step, on any thread: FAILED_PRECONDITION naming the state
  /// where it does not fit, what the sink says where it cannot be kept. A request that was carried
  /// out before is answered and no more.
  void start(RequestKey request, Reply reply);
  void pause(RequestKey request, Reply reply);
  void resume(RequestKey request, Reply reply);
  void stop(std::string reason, RequestKey request, Reply reply);
  void inject(InjectionOrder order, RequestKey request, Reply reply);
  /// Returns the injection that inject() would add, or the reason why it would not.
  using InjectionReply = std::function<void(absl::StatusOr<plan::InjectionSpec>)>;
  void foresee(InjectionOrder order, InjectionReply reply);
  void restore(RestoreOrder order, RequestKey request, Reply reply);
  /// Keeps the present state under an id.
  using CheckpointReply = std::function<void(absl::StatusOr<CheckpointRecord>)>;
  void checkpoint(std::string checkpoint, RequestKey request, CheckpointReply reply);
  /// The figures as they are now, with the state hash.
  void inspect(Reply reply);
  /// Ends it without a result once `forget` has deleted what is kept of it.
  void abandon(std::function<absl::Status()> forget, Reply reply);

  /// Suspends the session when the daemon ends, or another takes it over: it keeps its state and
  /// takes no step any more; commands are refused with `why`.
  using Done = std::function<void(absl::Status)>;
  void suspend(absl::Status why, Done done);
  /// Time since anything but figures was asked of it; 0 while it runs, is watched, is held or
  /// catches up. Does not wait.
  Clock::duration idle_time() const;
  /// True when it is held by hold(), or by a command that waits for its turn.
  bool is_held() const { return idle_.is_held() || !mailbox_.empty(); }
  /// Parks the session if it still is idle for so long: keeps its state and figures, after which it
  /// answers nothing any more but that it is parked.
  void park(std::chrono::duration<double> idle);

  /// Shows the meshes and the present frame to the viewer, then every frame it wants, until
  /// unwatch() or the end.
  void watch(std::shared_ptr<Viewer> viewer);
  void unwatch(std::shared_ptr<Viewer> viewer);
  /// Meshes and present fields of them (the last ones when it has ended).
  using CaptureReply = LiveSimulation::CaptureReply;
  void capture(std::vector<std::string> meshes, CaptureReply reply);
  /// Ends all viewers' streams, for the end of the daemon.
  void close_viewers(absl::Status status);

  /// Figures after the last step, without waiting for the one at hand.
  SessionView cached_view() const;
  /// Rows after `after_step` that are not in the sink yet.
  std::vector<SeriesEntry> pending_series(uint64_t after_step) const { return live().series().after(after_step); }

  WorkerPool::Next take_turn() override;

 private:
  friend std::shared_ptr<Session> hold(const std::shared_ptr<Session>& session);

  void give(SessionCommand command);
  void receive(const SessionCommand& command);
  absl::Status check_fits(const SessionCommand& command) const;
  void answer(const Reply& reply, const std::function<absl::Status()>& act);
  CommandRecord record_of(CommandKind kind, const std::string& payload) const;
  /// Has the sink keep a command, and lets it take effect unless an equal request did before.
  absl::Status keep_and_do(CommandKind kind, const std::string& payload, const RequestKey& request,
                           const std::function<void()>& act);
  absl::StatusOr<simulation::ResolvedInjection> resolve(const InjectionOrder& order) const;
  absl::Status add_injection(const InjectionOrder& order, const RequestKey& request);
  absl::Status go_back(RestoreOrder& order, const RequestKey& request);

  void run();
  void schedule();
  void withdraw();
  void carry_out_commands();
  bool can_be_parked(Clock::duration idle) const;
  /// Adds what the session alone knows.
  SessionView complete(SessionView view) const;
  LiveSimulation& live() { return run_.live(); }
  const LiveSimulation& live() const { return run_.live(); }

  const SessionOptions options_;
  WorkerPool& workers_;
  SessionSink& sink_;
  Mailbox mailbox_;
  IdleClock idle_;
  // These are for the one who acts, see Mailbox.
  SimulationRun run_;
  bool scheduled_ = false;  ///< the pool has it
  absl::Status why_suspended_;
};

/// The session, which is not parked as long as this is there: for whoever is about to ask something
/// of it. Null for null.
std::shared_ptr<Session> hold(const std::shared_ptr<Session>& session);

}  // namespace lipofill::server
