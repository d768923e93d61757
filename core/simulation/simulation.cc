#include "core/simulation/simulation.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/plan/plan_checks.h"
#include "core/plan/step_rules.h"
#include "core/simulation/simulation_impl.h"

namespace lipofill::simulation {
namespace {

/// A step that does not converge is tried again at half its size, down to this share of the plan's
/// step.
constexpr double kSmallestStepShare = 1.0 / 1024.0;
/// A step aims at this share of the size that the error estimate allows.
constexpr double kStepSafety = 0.8;

bool is_round_off_from(double time, double mark) {
  return std::abs(time - mark) <= 1e-12 * mark;
}

}  // namespace

Simulation::Simulation() : impl_(std::make_unique<Impl>()) {}
Simulation::~Simulation() = default;

absl::StatusOr<std::unique_ptr<Simulation>> Simulation::create(std::shared_ptr<const model::FaceModel> model,
                                                               plan::SimulationSpec spec) {
  std::unique_ptr<Simulation> simulation(new Simulation());
  simulation->impl_->model = std::move(model);
  simulation->impl_->spec = std::move(spec);
  const absl::Status status = simulation->impl_->set_up();
  if (!status.ok()) return status;
  return simulation;
}

absl::Status Simulation::Impl::set_up() {
  plan::PlacedPlan placed;
  if (const absl::Status status = plan::place_plan(*model, spec, nullptr, placed); !status.ok()) return status;
  films = std::move(placed.films);
  schedule = std::move(placed.schedule);
  probes = std::move(placed.probes);

  auto created = step::CoupledStep::create(*model, films, spec);
  if (!created.ok()) return created.status();
  stepper = *std::move(created);
  state = stepper->rest_state();
  frame_layout = make_frame_layout(model->geometry.grid, films, model->geometry);
  for (size_t f = 0; f < films.size(); ++f) {
    rest_film_vertices.push_back(stepper->geometry().metric_at(f, state.positions).vertices);
  }
  if (const absl::Status status = stepper->open_to_initial_thickness(state); !status.ok()) return status;
  state.next_step = spec.step;
  for (const mechanics::FilmState& film : state.films) initial_volume += film.volume.sum();
  decide_way();

  fill_report(stepper->describe(state), 0.0);
  return absl::OkStatus();
}

void Simulation::advance_step() {
  Impl& impl = *impl_;
  if (impl.phase != Phase::kRunning) return;
  double total_time = 0.0;
  {
    const mechanics::PhaseTimer timer(total_time);
    impl.advance();
  }
  impl.report.cost = impl.stepper->cost();
  impl.report.cost.times.total = total_time;
}

void Simulation::Impl::advance() {
  stepper->reset_cost();
  try {
    if (is_direct) decide_way();  // injections may have come since
    if (is_direct && settles_directly && settle()) return;
    is_direct = false;
    if (is_time_to_finish() && finish()) return;
    try_with_smaller_steps();
    if (!attempt.accepted) return fail(attempt.reason);
    accept(attempt.state.time - state.time);
  } catch (const std::bad_alloc&) {
    fail(absl::StrCat("at ", state.time, " s the machine ran out of memory"));
  } catch (const std::exception& error) {
    fail(absl::StrCat("ran out of a resource: ", error.what()));
  }
}

void Simulation::Impl::try_with_smaller_steps() {
  schedule.get_delivered(delivered_before);
  const double total = schedule.delivered();
  const double smallest = spec.step * kSmallestStepShare;
  uint64_t rejected = state.rejected_steps;
  for (double dt = first_step_to_try(smallest); dt >= smallest;) {
    const auto held = [this](int film, int cell) { return state.films[film].volume[cell]; };
    schedule.deliver(films, held, state.time, dt, injected);
    stepper->try_step(state, injected, dt, attempt);
    attempt.state.rejected_steps = rejected;
    if (attempt.accepted) {
      attempt.error = estimate_error(attempt.state, dt);
      if (dt <= spec.step || attempt.error <= spec.error_tolerance) return;
    }
    schedule.restore_delivered(delivered_before, total);
    ++rejected;
    dt = attempt.accepted ? std::max(spec.step, std::min(0.5 * dt, allowed_step(dt, attempt.error))) : 0.5 * dt;
  }
  attempt.accepted = false;
  attempt.reason = absl::StrCat("at ", state.time, " s, with steps down to ", smallest * 1e3, " ms: ", attempt.reason);
}

/// The step chosen, or less: where steps may grow while injecting, one ends where an injection
/// starts or ends, so that none is smeared over time, and the way there is halved rather than left
/// with a sliver of a step.
double Simulation::Impl::first_step_to_try(double smallest) const {
  const double dt = std::max(state.next_step, smallest);
  if (!spec.max_injection_step.has_value()) return dt;
  const double left = next_mark() - state.time;
  if (dt >= left) return std::max(left, smallest);
  return 2.0 * dt > left ? 0.5 * left : dt;
}

/// Time of the next event that a step may not run over: an injection starts or ends, or the
/// simulation does.
double Simulation::Impl::next_mark() const {
  return std::min(schedule.next_change(state.time), spec.end);
}

/// Local error of implicit Euler, dt^2 x''/2, from how far the step leaves the line of the last
/// one: the largest over the positions of the tissue and the thickness of the films [m].
double Simulation::Impl::estimate_error(const mechanics::SimulationState& next, double dt) const {
  double deviation = 0.0;
  if (state.positions.size() > 0) {
    deviation = (next.positions - state.positions - dt * state.velocities).colwise().norm().maxCoeff();
  }
  for (size_t f = 0; f < films.size(); ++f) {
    const auto off = next.films[f].volume - state.films[f].volume - dt * state.films[f].volume_rate;
    deviation = std::max(deviation, off.cwiseQuotient(stepper->geometry().rest_area(f)).cwiseAbs().maxCoeff());
  }
  return deviation * dt / (dt + state.last_step);
}

double Simulation::Impl::allowed_step(double dt, double error) const {
  const double room = spec.error_tolerance / std::max(error, 1e-300);
  return kStepSafety * dt * std::sqrt(std::min(room, 1e6));
}

void Simulation::Impl::accept(double dt) {
  const double last_speed = state.skin_speed;
  const bool ends_at_mark = spec.max_injection_step.has_value() && is_round_off_from(attempt.state.time, next_mark());
  if (ends_at_mark) attempt.state.time = next_mark();
  fill_report(attempt, dt);
  report.settling_error = estimate_settling_error(last_speed, dt);
  std::swap(state, attempt.state);
  state.skin_speed = report.skin_speed;
  choose_next_step(attempt, dt);
  if (ends_at_mark) state.next_step = spec.step;
  decide_phase();
}

/// Estimates how far the skin has still to go, if its speed goes on falling as it did over the last
/// step; infinity when it rose.
double Simulation::Impl::estimate_settling_error(double last_speed, double dt) const {
  if (report.skin_speed == 0.0) return 0.0;
  if (report.skin_speed >= last_speed) return std::numeric_limits<double>::infinity();
  return report.skin_speed * dt / std::log(last_speed / report.skin_speed);
}

void Simulation::Impl::choose_next_step(const step::StepOutcome& outcome, double dt) {
  const bool injecting = state.time < schedule.end();
  const double largest = (injecting ? spec.max_injection_step : spec.max_step).value_or(spec.step);
  const plan::StepRules rules = plan::rules_of(spec.goal);
  const bool easy = outcome.film_iterations <= rules.easy_film_iterations &&
                    outcome.newton_iterations <= rules.easy_newton_iterations;
  const double growth = easy ? std::min(rules.growth * dt, std::max(dt, allowed_step(dt, outcome.error))) : dt;
  state.next_step = std::min(std::max(growth, std::min(spec.step, 2.0 * dt)), largest);
}

void Simulation::Impl::decide_phase() {
  const bool slow =
      spec.settle_skin_speed > 0.0 && report.skin_speed < spec.settle_skin_speed && state.time >= schedule.end();
  state.slow_steps = slow ? state.slow_steps + 1 : 0;
  const bool falls = std::isfinite(report.settling_error);
  if (state.slow_steps >= plan::rules_of(falls ? spec.goal : plan::TimeGoal::kTransient).settled_steps) {
    phase = Phase::kSettled;
    reason = absl::StrCat("the skin moves slower than ", spec.settle_skin_speed * 1e3, " mm/s");
  } else if (state.time >= spec.end * (1.0 - 1e-12)) {
    phase = Phase::kFinished;
    reason = absl::StrCat("the end time of ", spec.end, " s came before the skin was at rest");
  }
}

void Simulation::Impl::fail(std::string why) {
  phase = Phase::kFailed;
  reason = std::move(why);
}

Phase Simulation::phase() const {
  return impl_->phase;
}
const std::string& Simulation::reason() const {
  return impl_->reason;
}
const StepReport& Simulation::report() const {
  return impl_->report;
}
const plan::SimulationSpec& Simulation::spec() const {
  return impl_->spec;
}
const model::FaceModel& Simulation::model() const {
  return *impl_->model;
}
const std::shared_ptr<const model::FaceModel>& Simulation::shared_model() const {
  return impl_->model;
}

absl::StatusOr<ResolvedInjection> Simulation::resolve(const plan::InjectionSpec& injection) const {
  if (impl_->phase != Phase::kRunning && impl_->phase != Phase::kSettled) {
    return absl::FailedPreconditionError(
        "the simulation has ended before it came to rest, and takes no more injections");
  }
  if (const absl::Status room = plan::check_room_for_injection(impl_->spec); !room.ok()) return room;
  ResolvedInjection resolved{injection, {}};
  std::optional<double>& start = resolved.spec.start;
  if (!start.has_value()) start = std::max(impl_->state.time, impl_->schedule.end());
  auto placed = impl_->schedule.place(*impl_->model, impl_->films, resolved.spec, impl_->state.time);
  if (!placed.ok()) return placed.status();
  resolved.placed = *std::move(placed);
  return resolved;
}

void Simulation::inject_resolved(const ResolvedInjection& injection) {
  impl_->schedule.add(injection.placed);
  impl_->spec.injections.push_back(injection.spec);
  impl_->state.next_step = std::min(impl_->state.next_step, impl_->spec.step);
  impl_->state.slow_steps = 0;
  if (impl_->phase == Phase::kSettled) impl_->reason.clear();
  impl_->phase = Phase::kRunning;
}

absl::Status Simulation::inject(const plan::InjectionSpec& injection) {
  const auto resolved = resolve(injection);
  if (resolved.ok()) inject_resolved(*resolved);
  return resolved.status();
}

int Simulation::n_hexahedra() const {
  return impl_->model->geometry.grid.n_hexahedra();
}
uint64_t Simulation::memory_bytes() const {
  return impl_->stepper->memory_bytes();
}
int Simulation::n_dofs() const {
  return impl_->stepper->n_dofs();
}

int Simulation::n_film_cells() const {
  int n = 0;
  for (const plan::FilmLayout& film : impl_->films) n += film.grid.n_cells();
  return n;
}

}  // namespace lipofill::simulation
