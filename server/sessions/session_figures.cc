#include "server/sessions/session_figures.h"

#include <algorithm>
#include <utility>

namespace lipofill::server {

SessionFigures::SessionFigures(const simulation::Simulation& simulation, SimulationState state,
                               const std::optional<PreviewView>& preview) {
  view_.state = state;
  view_.n_hexahedra = simulation.n_hexahedra();
  view_.n_film_cells = simulation.n_film_cells();
  view_.n_dofs = simulation.n_dofs();
  view_.preview = preview;
}

SessionView SessionFigures::copy() const {
  const std::lock_guard lock(mutex_);
  return view_;
}

SimulationState SessionFigures::state() const {
  const std::lock_guard lock(mutex_);
  return view_.state;
}

void SessionFigures::set_state(SimulationState state, std::string reason) {
  const std::lock_guard lock(mutex_);
  view_.state = state;
  view_.reason = std::move(reason);
}

void SessionFigures::set_reason(std::string reason) {
  const std::lock_guard lock(mutex_);
  view_.reason = std::move(reason);
}

void SessionFigures::set_unkept(std::string unkept) {
  const std::lock_guard lock(mutex_);
  view_.unkept = std::move(unkept);
}

void SessionFigures::set_catching_up(std::optional<uint64_t> until_step) {
  const std::lock_guard lock(mutex_);
  view_.catching_up_to = until_step;
}

void SessionFigures::set_preview(const std::optional<PreviewView>& preview) {
  const std::lock_guard lock(mutex_);
  view_.preview = preview;
}

void SessionFigures::set_discretisation(std::optional<absl::StatusOr<simulation::DiscretisationError>> error) {
  const std::lock_guard lock(mutex_);
  view_.discretisation = std::move(error);
}

void SessionFigures::count_step(const mechanics::StepCost& cost, double wall_ms) {
  cost_.add(cost);
  step_ms_.push_back(static_cast<float>(wall_ms));
}

void SessionFigures::measure(const simulation::Simulation& simulation, double wall_s) {
  std::vector<simulation::ZoneReport> zones = simulation.zone_reports();
  std::vector<simulation::LigamentReport> ligaments = simulation.ligament_reports();
  std::vector<std::string> remarks = simulation.remarks();
  const std::lock_guard lock(mutex_);
  view_.report = simulation.report();
  view_.zones = std::move(zones);
  view_.ligaments = std::move(ligaments);
  view_.remarks = std::move(remarks);
  view_.wall_s = wall_s;
  view_.cost = cost_;
}

void SessionFigures::show(SessionView view) {
  const std::lock_guard lock(mutex_);
  view_ = std::move(view);
}

double SessionFigures::step_ms_median() const {
  if (step_ms_.empty()) return 0.0;
  std::vector<float> sorted = step_ms_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

}  // namespace lipofill::server
