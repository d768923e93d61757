#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/sessions/session_sink.h"

namespace lipofill::server {

/// The figures of a simulation as others see them: those after its last step, which they get
/// without waiting for the one at hand. One thread at a time changes them; any thread may copy
/// them.
///
/// Checked by tests/unit/server/sessions/session_figures_test.cc.
class SessionFigures {
 public:
  SessionFigures(const simulation::Simulation& simulation, SimulationState state,
                 const std::optional<PreviewView>& preview);

  // These may be called by any thread.
  SessionView copy() const;
  SimulationState state() const;

  // These are for the thread that changes them.
  const SessionView& latest() const { return view_; }
  void set_state(SimulationState state, std::string reason);
  void set_reason(std::string reason);
  void set_unkept(std::string unkept);
  void set_catching_up(std::optional<uint64_t> until_step);
  void set_preview(const std::optional<PreviewView>& preview);
  void set_discretisation(std::optional<absl::StatusOr<simulation::DiscretisationError>> error);
  /// Counts a step that took this long.
  void count_step(const mechanics::StepCost& cost, double wall_ms);
  /// Takes the figures of the present state.
  void measure(const simulation::Simulation& simulation, double wall_s);
  /// Shows these from now on, when there is no simulation to take them from.
  void show(SessionView view);
  /// Median time of a step [ms]; 0 before the first.
  double step_ms_median() const;

 private:
  mutable std::mutex mutex_;
  SessionView view_;
  mechanics::CostSum cost_;
  std::vector<float> step_ms_;
};

}  // namespace lipofill::server
