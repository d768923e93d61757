#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/sessions/checkpoint_schedule.h"
#include "server/sessions/live_simulation.h"
#include "server/sessions/replay.h"
#include "server/sessions/worker_pool.h"

namespace lipofill::server {

/// The steps of a session between its commands, a slice at a time: what was acknowledged before the
/// daemon was started again is repeated first, then comes the preview, then the simulation's own
/// steps, at their pace; meanwhile the state is kept at intervals. The last step ends it. For one
/// thread at a time.
///
/// Checked by tests/unit/server/sessions/session_test.cc and
/// tests/unit/server/sessions/session_resume_test.cc.
class SimulationRun {
 public:
  using Clock = RunClock::Clock;

  SimulationRun(const SessionOptions& options, std::unique_ptr<simulation::Simulation> simulation,
                SessionHistory history, SessionSink& sink);

  /// The simulation, which has the state READY, RUNNING, PAUSED, or one of those it ended in.
  LiveSimulation& live() { return live_; }
  const LiveSimulation& live() const { return live_; }
  SimulationState state() const { return live_.figures().latest().state; }

  /// True when there is a step to take, now or when its time comes.
  bool takes_steps() const;
  bool is_catching_up() const { return replay_.under_way(); }
  /// Takes steps for a slice of time, and carries out commands after each. Returns when to go on.
  WorkerPool::Next advance_slice(const std::function<void()>& carry_out_commands);

  /// Goes on with what it was made with, and says what there is to repeat.
  void go_on();
  /// RUNNING from here.
  void run();
  /// PAUSED from here.
  void pause();
  /// Ends it in this state, with a result.
  void finish(SimulationState state, std::string reason);
  /// Ends it without a result, unless it has ended.
  void abandon();
  /// Takes no step any more: the daemon ends.
  void suspend() { suspended_ = true; }
  bool is_suspended() const { return suspended_; }
  /// Keeps its state and its figures, and releases the simulation. What the sink says where that
  /// cannot be; ABORTED when somebody holds it.
  absl::Status park();
  bool is_parked() const { return parked_; }

  /// Goes back to the state of a checkpoint.
  void go_back(const CheckpointRecord& checkpoint, std::unique_ptr<simulation::Simulation> simulation);
  absl::StatusOr<CheckpointRecord> keep_checkpoint(CheckpointKind kind, const std::string& id,
                                                   const RequestKey& request);
  /// Keeps the present state, unless it is kept already or can be had at no cost.
  absl::Status save();
  /// True when it is to keep its state by itself.
  bool keeps_its_state() const { return checkpoints_.is_on(); }

 private:
  void advance(bool previews);
  void fail_step(const std::string& why);
  void catch_up();
  absl::Status keep_automatically();
  void checkpoint_when_due();
  void let_go();

  const std::string id_;
  const bool real_time_;
  LiveSimulation live_;
  Replay replay_;
  CheckpointSchedule checkpoints_;
  bool suspended_ = false;
  bool parked_ = false;
};

}  // namespace lipofill::server
