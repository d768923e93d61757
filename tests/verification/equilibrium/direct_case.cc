#include "tests/verification/equilibrium/direct_case.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

namespace lipofill::verification {

DirectCase::DirectCase(std::shared_ptr<const model::FaceModel> model, plan::SimulationSpec spec)
    : model_(std::move(model)), spec_(std::move(spec)) {
  EXPECT_TRUE(plan::place_plan(*model_, spec_, nullptr, placed_).ok());
  cells_ = mechanics::number_cells(placed_.films);
  auto system = mechanics::TissueSystem::create(*model_, placed_.films, cells_, spec_, cost_);
  EXPECT_TRUE(system.ok()) << system.status();
  system_ = *std::move(system);
  geometry_ = std::make_unique<mechanics::FilmGeometry>(model_->geometry.grid, placed_.films, cells_, system_.get());
  auto equilibrium = equilibrium::Equilibrium::create(*model_, placed_.films, cells_, *system_, *geometry_,
                                                      {spec_.gravity, spec_.fat_density}, cost_);
  EXPECT_TRUE(equilibrium.ok()) << equilibrium.status();
  equilibrium_ = *std::move(equilibrium);
}

equilibrium::PoolTarget DirectCase::target() const {
  Eigen::VectorXd volume(cells_.n());
  plan::InjectionSchedule schedule = placed_.schedule;
  std::vector<Eigen::VectorXd> injected;
  const auto enough = [](int, int) { return std::numeric_limits<double>::max(); };
  schedule.deliver(placed_.films, enough, 0.0, schedule.end(), injected);
  for (size_t f = 0; f < placed_.films.size(); ++f) {
    const plan::FilmLayout& film = placed_.films[f];
    for (int cell = 0; cell < cells_.n_of(f); ++cell) {
      const geometry::ChartPoint centre = film.cell_centre(cell);
      volume[cells_.offset[f] + cell] =
          geometry_->rest_area(f)[cell] * film.initial_thickness.at(centre.xi, centre.eta) + injected[f][cell];
    }
  }
  Eigen::VectorXd on_tissue;
  cells_.gather_tissue_part(volume, on_tissue);
  equilibrium::PoolTarget target;
  target.volume = pools().sum(on_tissue);
  if (spec_.suction_limit.has_value()) target.lowest_head = -*spec_.suction_limit;
  return target;
}

equilibrium::Settled DirectCase::solve(double tolerance) {
  return solve(target(), tolerance);
}

equilibrium::Settled DirectCase::solve(const equilibrium::PoolTarget& target, double tolerance) {
  return equilibrium_->find(target, Eigen::VectorXd::Ones(system_->n_ligament_springs()), tolerance);
}

Eigen::Matrix3Xd DirectCase::skin(const equilibrium::Settled& settled) const {
  const std::vector<int>& nodes = system_->setup().skin_nodes;
  return settled.positions(Eigen::all, nodes) - system_->rest_positions()(Eigen::all, nodes);
}

std::unique_ptr<simulation::Simulation> step_until_at_rest(std::shared_ptr<const model::FaceModel> model,
                                                           plan::SimulationSpec spec, double left) {
  spec.settle_skin_speed = 1e-12;
  spec.end = 1e6;
  spec.max_step = 60.0;
  spec.max_injection_step = 0.5;
  spec.error_tolerance = 0.2e-3;
  auto created = simulation::Simulation::create(std::move(model), spec);
  EXPECT_TRUE(created.ok()) << created.status();
  if (!created.ok()) return nullptr;
  simulation::Simulation& simulation = **created;
  const double injected_until = [&] {
    double end = 0.0;
    for (const plan::InjectionSpec& injection : spec.injections) {
      end = std::max(end, injection.start.value_or(end)) + std::abs(injection.volume) / injection.rate;
    }
    return end;
  }();
  while (simulation.phase() == simulation::Phase::kRunning) {
    simulation.advance_step();
    if (simulation.report().time > injected_until + 1.0 && simulation.report().settling_error < left) break;
  }
  EXPECT_NE(simulation.phase(), simulation::Phase::kFailed) << simulation.reason();
  return *std::move(created);
}

Eigen::Matrix3Xd skin_of(const simulation::Simulation& simulation) {
  for (const simulation::FrameField& field : simulation.frame({"skin"})) {
    if (field.name != "displacement") continue;
    return 1e-3 * Eigen::Map<const Eigen::Matrix3Xf>(field.values.data(), 3,
                                                     static_cast<Eigen::Index>(field.values.size() / 3))
                      .cast<double>();
  }
  ADD_FAILURE() << "a frame without the skin's displacement";
  return {};
}

}  // namespace lipofill::verification
