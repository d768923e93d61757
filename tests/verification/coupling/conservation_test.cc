// What no scheme may lose: volume, what walls hold, and the balance of forces between the film and
// its two walls.

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/coupling/gap_volume.h"
#include "core/mechanics/tissue_setup.h"
#include "core/plan/film_layout.h"
#include "tests/verification/film/film_cases.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

using geometry::ChartPoint;
using geometry::ScalarField;

constexpr double kSide = 0.04;

/// Skin over a deeper layer on bone: both walls of the film between them give way.
std::shared_ptr<const model::FaceModel> make_two_layers() {
  model::FaceModelSpec spec;
  spec.region = geometry::SquareSpec{kSide, kSide};
  spec.n_xi = spec.n_eta = 16;
  spec.layers = {{"skin", {ScalarField::constant(2e-3), 1}, {2e5, 0.45, 1100.0}},
                 {"fat", {ScalarField::constant(6e-3), 2}, {2e4, 0.48, 950.0}}};
  auto model = model::build_face_model(spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  return *model;
}

/// A film of two zones side by side, their common edge sealed; fat goes into the left one at a
/// point.
plan::SimulationSpec make_two_zones(plan::FilmWallKind wall) {
  plan::SimulationSpec spec;
  spec.films = {make_film(wall, 8, 8)};
  spec.films[0].wall_stiffness = wall == plan::FilmWallKind::kWinkler ? 1e6 : 0.0;
  if (wall == plan::FilmWallKind::kTissue) spec.films[0].below_layer = "skin";
  spec.films[0].zones = {{"left", geometry::ChartBox{0.0, 0.5, 0.0, 1.0}},
                         {"right", geometry::ChartBox{0.5, 1.0, 0.0, 1.0}}};
  spec.films[0].rest_thickness = ScalarField::constant(0.1e-3);
  spec.injections = {{"left", 0.5e-6, 1e-6, 0.0, ChartPoint{0.3, 0.4}}};
  spec.step = 0.02;
  spec.end = 1.0;
  spec.settle_skin_speed = 0.0;
  return spec;
}

struct Ledger {
  double volume_error = 0.0;  ///< worst over all steps, share of what was injected
  double gap_error = 0.0;
  double leaked = 0.0;  ///< change of the unfed zone's volume, share of what was injected
};

/// What the injected volume, the film's and the zones' say, every step.
Ledger keep_ledger(plan::FilmWallKind wall) {
  const plan::SimulationSpec spec = make_two_zones(wall);
  auto simulation = make_simulation(make_two_layers(), spec);
  if (!simulation) return {1.0, 1.0, 1.0};
  const double rest = simulation->zone_reports()[1].volume;
  Ledger ledger;
  while (simulation->phase() == simulation::Phase::kRunning) {
    simulation->advance_step();
    const simulation::StepReport& report = simulation->report();
    const auto share = [&](double volume) { return std::abs(volume) / report.injected; };
    ledger.volume_error =
        std::max(ledger.volume_error, share(report.film_volume - report.initial_volume - report.injected));
    ledger.gap_error = std::max(ledger.gap_error, share(report.gap_volume - report.film_volume));
    ledger.leaked = std::max(ledger.leaked, share(simulation->zone_reports()[1].volume - rest));
  }
  EXPECT_EQ(simulation->phase(), simulation::Phase::kFinished) << simulation->reason();
  EXPECT_NEAR(simulation->report().injected, 0.5e-6, 1e-18);
  return ledger;
}

TEST(Conservation, VolumeAndSealedEdges) {
  Case ledger_case({"conservation/1-volume", "Volume and sealed edges, every step of an injection",
                    "None: what is injected is in the film, and none of it beyond a sealed edge."});
  const Ledger tissue = keep_ledger(plan::FilmWallKind::kTissue);
  const Ledger winkler = keep_ledger(plan::FilmWallKind::kWinkler);
  ledger_case.record(
      {"film below tissue: |film - injected|/injected", "1", 1e-12, tissue.volume_error, 0.0, Bound::kAtMost});
  ledger_case.record({"film below tissue: |gap - film|/injected", "1", 1e-4, tissue.gap_error, 0.0, Bound::kAtMost});
  ledger_case.record({"film below tissue: leaked into the next zone", "1", 1e-12, tissue.leaked, 0.0, Bound::kAtMost});
  ledger_case.record(
      {"Winkler wall: |film - injected|/injected", "1", 1e-12, winkler.volume_error, 0.0, Bound::kAtMost});
  ledger_case.record({"Winkler wall: leaked into the next zone", "1", 1e-12, winkler.leaked, 0.0, Bound::kAtMost});
}

/// Energy over an injection and after it.
struct EnergyLedger {
  double missing = 0.0;  ///< work that is neither stored nor dissipated at the end, share of the work
  double growth = 0.0;   ///< most that elastic and kinetic energy grew in a step after the injection, share of the work
};

EnergyLedger keep_energy(double step) {
  plan::SimulationSpec spec = make_two_zones(plan::FilmWallKind::kTissue);
  spec.step = step;
  auto simulation = make_simulation(make_two_layers(), spec);
  if (!simulation) return {1.0, 1.0};
  EnergyLedger ledger;
  double before = 0.0;
  while (simulation->phase() == simulation::Phase::kRunning) {
    const double injected = simulation->report().injected;
    simulation->advance_step();
    const simulation::StepReport& report = simulation->report();
    const double stored = report.elastic_energy + report.kinetic_energy;
    if (injected == report.injected) ledger.growth = std::max(ledger.growth, (stored - before) / report.injection_work);
    before = stored;
  }
  EXPECT_EQ(simulation->phase(), simulation::Phase::kFinished) << simulation->reason();
  const simulation::StepReport& report = simulation->report();
  EXPECT_GT(report.injection_work, 0.0);
  EXPECT_GT(report.film_dissipation, 0.0);
  ledger.missing = 1.0 - (before + report.film_dissipation) / report.injection_work;
  return ledger;
}

/// What is missing is what implicit Euler dissipates of itself: it shrinks with the step.
TEST(Conservation, EnergyBalances) {
  Case energy({"conservation/3-energy", "Energy of an injection into tissue",
               "None: work = elastic + kinetic + dissipated, and nothing grows without a source."});
  const std::vector<double> steps = {0.04, 0.02, 0.01};
  std::vector<double> missing;
  EnergyLedger fine;
  for (const double step : steps) {
    fine = keep_energy(step);
    missing.push_back(fine.missing);
    EXPECT_LE(fine.growth, 1e-9);
  }
  energy.record(
      {"work neither stored nor dissipated, steps of 10 ms: share", "1", 0.05, fine.missing, 0.0, Bound::kAtMost});
  energy.record(
      {"growth of stored energy in a step without a source: share", "1", 1e-9, fine.growth, 0.0, Bound::kAtMost});
  energy.record_series({"energy balance", "step [s]", steps, missing, 1.0, 0.8});
}

/// Share of the pressure's forces that is left when those on both walls are added up, and of their
/// moments about the middle.
struct Imbalance {
  double force = 0.0;
  double torque = 0.0;
};

Imbalance add_up(const Eigen::Matrix3Xd& force, const Eigen::Matrix3Xd& x) {
  Eigen::Vector3d net = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double forces = 0.0;
  double moments = 0.0;
  const Eigen::Vector3d middle = x.rowwise().mean();
  for (Eigen::Index a = 0; a < x.cols(); ++a) {
    const Eigen::Vector3d arm = x.col(a) - middle;
    net += force.col(a);
    moment += arm.cross(Eigen::Vector3d(force.col(a)));
    forces += force.col(a).norm();
    moments += arm.norm() * force.col(a).norm();
  }
  return {net.norm() / forces, moment.norm() / moments};
}

/// B^T p of an uneven pressure, with every node free to feel it and the walls bent apart.
TEST(Conservation, ActionEqualsReaction) {
  const auto model = make_two_layers();
  const plan::SimulationSpec spec = make_two_zones(plan::FilmWallKind::kTissue);
  const auto layout = plan::place_film(*model, spec.films[0]);
  ASSERT_TRUE(layout.ok()) << layout.status();
  const mechanics::HeldMesh held = mechanics::hold_mesh(*model, {*layout});
  Eigen::Matrix3Xd x = held.split.mesh.rest_positions;
  for (int a = 0; a < x.cols(); ++a) {
    const Eigen::Vector3d X = x.col(a);
    x.col(a) += 1e-3 * Eigen::Vector3d(std::sin(90.0 * X[1] + 0.1 * a), std::cos(70.0 * X[0]), std::sin(1.7 * a));
  }
  std::vector<int> free_dofs(3 * x.cols());
  for (size_t k = 0; k < free_dofs.size(); ++k) free_dofs[k] = static_cast<int>(k);
  coupling::GapVolume gap(model->geometry.grid, held.walls[0], layout->grid, free_dofs,
                          static_cast<int>(free_dofs.size()));
  gap.evaluate(x);
  Eigen::VectorXd pressure(layout->grid.n_cells());
  for (int i = 0; i < pressure.size(); ++i) pressure[i] = 1e3 * (1.0 + std::sin(2.3 * i));
  const Eigen::VectorXd force = gap.derivative().transpose() * pressure;
  ASSERT_GT(force.norm(), 0.0);
  const Imbalance left = add_up(force.reshaped(3, x.cols()), x);
  Case reaction({"conservation/2-reaction", "The film's force on its two walls, B^T p of an uneven pressure",
                 "None: action equals reaction."});
  reaction.record({"net force, share of all forces", "1", 1e-13, left.force, 0.0, Bound::kAtMost});
  reaction.record({"net moment, share of all moments", "1", 1e-13, left.torque, 0.0, Bound::kAtMost});
}

}  // namespace
}  // namespace lipofill::verification
