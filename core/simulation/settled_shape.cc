// Settled shapes in place of steps.

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/units.h"
#include "core/simulation/simulation_impl.h"

namespace lipofill::simulation {

/// Decides whether the plan is solved directly, or finished so, and says why not.
void Simulation::Impl::decide_way() {
  settles_directly = finishes_directly = false;
  if (spec.goal == plan::TimeGoal::kTransient) {
    report.way = "in steps: time.goal is TRANSIENT";
    return;
  }
  const auto find_hindrance = [&](bool is_injected) {
    return DirectShape::find_hindrance(*model, films, spec, schedule, state, *stepper, is_injected);
  };
  const auto hindrance = find_hindrance(false);
  settles_directly = !hindrance.has_value();
  finishes_directly = hindrance && hindrance->ends_with_injection && !find_hindrance(true);
  report.way = settles_directly
                   ? "directly"
                   : absl::StrCat("in steps", finishes_directly ? " until all is injected, then directly" : "", ": ",
                                  hindrance->text());
}

absl::Status Simulation::Impl::make_direct() {
  if (direct != nullptr) return absl::OkStatus();
  auto created = DirectShape::create(*model, films, spec, *stepper);
  if (created.ok()) direct = *std::move(created);
  return created.status();
}

/// One step to the settled shape: all is injected, and the time is that when the last injection
/// ends. False where there is not even the beginning of a path to it; the plan is then stepped.
bool Simulation::Impl::settle() {
  if (const absl::Status made = make_direct(); !made.ok()) {
    fail(std::string(made.message()));
    return true;
  }
  const double end = std::max(schedule.end(), state.time + spec.step);
  schedule.get_delivered(delivered_before);
  const double total = schedule.delivered();
  schedule.deliver_all(films, state.time, end - state.time, injected);
  mechanics::SimulationState next;
  const equilibrium::Settled settled = direct->find(state, injected, next);
  if (settled.share == 0.0) {
    schedule.restore_delivered(delivered_before, total);
    report.way = absl::StrCat("in steps: no equilibrium was found, ", settled.reason);
    return false;
  }
  become(settled, std::move(next), end);
  return true;
}

/// True at the first state with all injections over, on whichever way it was come by.
bool Simulation::Impl::is_just_injected() const {
  return state.time >= schedule.end() && state.time - state.last_step < schedule.end();
}

/// The settled shape of what has been injected in steps, with the ligaments that hold. False where
/// there is none, or where one of them breaks in it; the plan is then stepped on.
bool Simulation::Impl::finish() {
  if (const absl::Status made = make_direct(); !made.ok()) {
    fail(std::string(made.message()));
    return true;
  }
  for (size_t f = 0; f < films.size(); ++f) injected[f].setZero();
  mechanics::SimulationState next;
  const equilibrium::Settled settled = direct->find(state, injected, next);
  const auto breaking = direct->find_breaking_ligament(stepper->tissue()->ligaments);
  if (!settled.is_whole() || breaking) {
    report.way =
        absl::StrCat("in steps: ", settled.is_whole() ? absl::StrCat("'", *breaking, "' breaks after all is injected")
                                                      : absl::StrCat("no equilibrium was found, ", settled.reason));
    return false;
  }
  become(settled, std::move(next), state.time + spec.step);
  return true;
}

/// Takes up a shape, as the one of `time`.
void Simulation::Impl::become(const equilibrium::Settled& settled, mechanics::SimulationState next, double time) {
  next.step = state.step + 1;
  next.time = time;
  next.last_step = time - state.time;
  attempt = stepper->describe(next);
  attempt.newton_iterations = settled.cost.iterations;
  if (!settled.is_whole()) {
    schedule.get_delivered(delivered_before);
    for (double& delivered : delivered_before) delivered *= settled.share;
    schedule.restore_delivered(delivered_before, settled.share * schedule.delivered());
  }
  fill_report(attempt, next.last_step);
  report.settling_error = 0.0;
  std::swap(state, attempt.state);
  if (settled.is_whole()) {
    phase = Phase::kSettled;
    reason = "the settled shape was found directly";
  } else {
    end_path(settled);
  }
}

void Simulation::Impl::end_path(const equilibrium::Settled& settled) {
  fail(absl::StrFormat(
      "only %.1f %% of the volume goes in, %.2f mL at up to %.2f kPa with the skin moved by %.2f mm: beyond that %s; "
      "inject less, or into a larger zone",
      100.0 * settled.share, report.film_volume / kCubicMetresPerMillilitre,
      report.max_pressure / kPascalsPerKilopascal, report.skin_max_displacement * kMillimetresPerMetre,
      settled.reason));
}

}  // namespace lipofill::simulation
