// Settled shapes in place of steps.

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/units.h"
#include "core/simulation/simulation_impl.h"
#include "core/step/tissue_entry.h"

namespace lipofill::simulation {
namespace {

/// Steps between tries to finish a plan whose fat entered more tissue than a try had it: a try
/// costs about as much as they do.
constexpr uint64_t kStepsBetweenTries = 8;
/// Every cell that fat has yet to enter holds its own volume. With more of them the rows of the
/// direct solution take more time and memory than steps.
constexpr Eigen::Index kMostCellsToEnter = 600;

/// The first film on whose tissue the pressure enters more of it.
std::optional<size_t> find_film_to_be_entered(const std::vector<plan::FilmLayout>& films,
                                              mechanics::SimulationState& state) {
  for (size_t f = 0; f < films.size(); ++f) {
    if (step::enter_cells_beside_pressure(films[f], state.films[f])) return f;
  }
  return {};
}

Eigen::Index count_cells_to_enter(const mechanics::SimulationState& state) {
  Eigen::Index n = 0;
  for (const mechanics::FilmState& film : state.films) n += (film.is_entered.array() == 0.0).count();
  return n;
}

}  // namespace

/// Decides whether the plan is solved directly, or finished so, and says why not.
void Simulation::Impl::decide_way() {
  settles_directly = finishes_directly = false;
  if (spec.goal == plan::TimeGoal::kTransient) {
    report.way = "in steps: time.goal is TRANSIENT";
    return;
  }
  hindrance.clear();
  const auto find_hindrance = [&](bool is_injected) {
    return DirectShape::find_hindrance(*model, films, spec, schedule, state, *stepper, is_injected);
  };
  const auto found = find_hindrance(false);
  settles_directly = !found.has_value();
  finishes_directly = found && found->ends_with_injection && !find_hindrance(true);
  if (found) hindrance = found->text();
  report.way =
      settles_directly
          ? "directly"
          : absl::StrCat("in steps", finishes_directly ? " until all is injected, then directly" : "", ": ", hindrance);
}

absl::Status Simulation::Impl::make_direct() {
  if (direct != nullptr) return absl::OkStatus();
  auto created = DirectShape::create(*model, films, spec, *stepper, state);
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

/// True at that state, unless fat is about to enter more tissue; then, while it does not, every so
/// many steps: it may again after a failure.
bool Simulation::Impl::is_time_to_finish() const {
  if (!finishes_directly || state.time < schedule.end()) return false;
  const bool has_tissue_to_enter =
      std::any_of(state.films.begin(), state.films.end(), [](const auto& film) { return film.is_entered.size() > 0; });
  if (!has_tissue_to_enter) return is_just_injected();
  mechanics::SimulationState next = state;
  return !find_film_to_be_entered(films, next) && (is_just_injected() || state.step % kStepsBetweenTries == 0);
}

/// The settled shape of what has been injected in steps, with the ligaments that hold and the
/// tissue that fat has entered. False where there is none, or where in it a ligament breaks or fat
/// enters more; the plan is then stepped on.
bool Simulation::Impl::finish() {
  const Eigen::Index n_to_enter = count_cells_to_enter(state);
  if (n_to_enter > kMostCellsToEnter) {
    report.way = absl::StrCat("in steps: fat has yet to enter ", n_to_enter, " cells, more than the ",
                              kMostCellsToEnter, " with which the shape is found directly");
    return false;
  }
  const std::unique_ptr<DirectShape> before = std::move(direct);  // what it shares is held until the next one is there
  if (const absl::Status made = make_direct(); !made.ok()) {
    fail(std::string(made.message()));
    return true;
  }
  for (size_t f = 0; f < films.size(); ++f) injected[f].setZero();
  mechanics::SimulationState next;
  const equilibrium::Settled settled = direct->find(state, injected, next);
  if (const std::string why_not = find_why_not_finished(settled, next); !why_not.empty()) {
    report.way = absl::StrCat("in steps: ", why_not);
    return false;
  }
  report.way = absl::StrCat("in steps until ", is_just_injected() ? "all is injected" : "fat enters no more tissue",
                            ", then directly: ", hindrance);
  become(settled, std::move(next), state.time + spec.step);
  return true;
}

/// Says why a shape is not the one that steps would come to; empty where it is.
std::string Simulation::Impl::find_why_not_finished(const equilibrium::Settled& settled,
                                                    mechanics::SimulationState next) const {
  if (!settled.is_whole()) return absl::StrCat("no equilibrium was found, ", settled.reason);
  if (const auto breaking = direct->find_breaking_ligament(stepper->tissue()->ligaments)) {
    return absl::StrCat("'", *breaking, "' breaks after all is injected");
  }
  if (const auto film = find_film_to_be_entered(films, next)) {
    return absl::StrCat("fat enters more tissue in films[", *film, "] after all is injected");
  }
  return "";
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
