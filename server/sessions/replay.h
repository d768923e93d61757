#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/simulation/simulation.h"
#include "server/store/records.h"

namespace lipofill::server {

/// The commands acknowledged before the daemon was started again that are not yet in the state the
/// session goes on from. They take effect after the same steps as the first time.
struct SessionHistory {
  SimulationState state = SimulationState::kReady;
  double wall_s = 0.0;     ///< spent RUNNING
  bool was_there = false;  ///< it was made before the daemon was started again
  /// This is what the state has in it already, and the commands after that.
  uint64_t last_command = 0;
  struct Taken {
    uint64_t number = 0;
    uint64_t step = 0;
  };
  std::vector<Taken> commands;
  struct Injection {
    uint64_t step = 0;
    plan::InjectionSpec spec;
  };
  std::deque<Injection> injections;
  uint64_t until_step = 0;  ///< where the last command took effect
  std::optional<std::string> stop_reason;
  std::string note;  ///< what was not as it should be
};

/// Repeats a history step by step, until the simulation is where it was when the daemon ended.
///
/// Checked by tests/unit/server/sessions/replay_test.cc and
/// tests/unit/server/sessions/session_resume_test.cc.
class Replay {
 public:
  /// @param step  of the state that the session goes on from
  Replay(SessionHistory history, uint64_t step);

  bool under_way() const { return under_way_; }
  /// Repeats what took effect after the step the simulation is at. DATA_LOSS, or what the
  /// simulation says, when something cannot be repeated.
  absl::Status repeat(simulation::Simulation& simulation);
  /// True when an injection is to be repeated at this step or later: what came to rest there went
  /// on.
  bool goes_on_after(uint64_t step) const {
    return under_way_ && !history_.injections.empty() && history_.injections.back().step >= step;
  }
  /// True when nothing is left to repeat at this step or later, but for the stop.
  bool has_caught_up(uint64_t step) const { return history_.injections.empty() && step >= history_.until_step; }
  /// The number of the last command that is in a state after so many steps, before repeat() was
  /// called for it; 0 when nothing is under way: all are.
  uint64_t last_command_in(uint64_t step) const;
  /// The step at which it will have caught up; none once it has.
  std::optional<uint64_t> until_step() const;
  bool was_there() const { return history_.was_there; }
  /// The reason of the stop that ended it, if one did.
  const std::optional<std::string>& stop_reason() const { return history_.stop_reason; }
  void end() { under_way_ = false; }

  /// Says what is to be told of it as long as it is under way, and after: what was not as it should
  /// be.
  std::string describe() const;
  const std::string& note() const { return history_.note; }

 private:
  SessionHistory history_;
  bool under_way_;
};

}  // namespace lipofill::server
