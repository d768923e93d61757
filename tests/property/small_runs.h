#pragma once

#include <rapidcheck.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {

/// A number between `low` and `high`, of a hundred steps: failing cases shrink towards `low`, and
/// print it by its name.
inline double pick(const std::string& name, double low, double high) {
  return *rc::gen::map(rc::gen::inRange(0, 101), [=](int k) { return low + (high - low) * k / 100.0; }).as(name);
}
inline bool pick(const std::string& question) {
  return *rc::gen::arbitrary<bool>().as(question);
}

/// An injection into one of the two zones, at a place in it or along it.
inline plan::InjectionSpec pick_injection() {
  const bool right = pick("right zone?");
  plan::InjectionSpec injection;
  injection.zone = right ? "right" : "left";
  injection.volume = pick("volume [m3]", 0.02e-6, 0.15e-6);
  injection.rate = pick("rate [m3/s]", 0.5e-6, 2e-6);
  if (pick("at a place?")) {
    injection.site = geometry::ChartPoint{pick("xi", 0.1, 0.4) + (right ? 0.5 : 0.0), pick("eta", 0.1, 0.9)};
  }
  return injection;
}

/// The small plan with two zones and up to three injections, one after the other; it does not end
/// by itself.
inline plan::SimulationSpec pick_plan() {
  plan::SimulationSpec spec = make_small_plan();
  spec.films[0].zones = {{"left", geometry::ChartBox{0.0, 0.5, 0.0, 1.0}},
                         {"right", geometry::ChartBox{0.5, 1.0, 0.0, 1.0}}};
  spec.injections.clear();
  const int n_injections = *rc::gen::inRange(1, 4).as("injections");
  for (int k = 0; k < n_injections; ++k) spec.injections.push_back(pick_injection());
  if (pick("lumped?")) spec.coupling = plan::CouplingMode::kLumped;
  spec.fat_viscosity = pick("viscosity [Pa s]", 5.0, 50.0);
  spec.fat_flow_index = pick("flow index", 1.0, 0.5);
  spec.damping_mass = pick("damping [1/s]", 0.0, 2.0);
  spec.settle_skin_speed = 0.0;
  return spec;
}

/// The small model, built once.
inline std::shared_ptr<const model::FaceModel> small_model() {
  static const std::shared_ptr<const model::FaceModel> model = make_small_model();
  return model;
}

/// A simulation of a plan that must be accepted.
inline std::unique_ptr<Simulation> start(const plan::SimulationSpec& spec,
                                         const std::shared_ptr<const model::FaceModel>& model = small_model()) {
  auto created = Simulation::create(model, spec);
  if (!created.ok()) RC_FAIL(created.status().ToString());
  return *std::move(created);
}

/// Steps that must succeed.
inline void advance(Simulation& simulation, int steps) {
  for (int k = 0; k < steps; ++k) simulation.advance_step();
  if (simulation.phase() == Phase::kFailed) RC_FAIL(simulation.reason());
}

/// Displacement of the skin's nodes [mm] (3, n).
inline Eigen::Matrix3Xd skin_displacement(const Simulation& simulation) {
  for (const FrameField& field : simulation.frame({"skin"})) {
    if (field.name != "displacement") continue;
    const auto n = static_cast<Eigen::Index>(field.values.size() / 3);
    return Eigen::Map<const Eigen::Matrix3Xf>(field.values.data(), 3, n).cast<double>();
  }
  return {};
}

/// Largest distance between two fields of displacements, as a share of the largest displacement.
inline double difference(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  RC_ASSERT(a.cols() == b.cols());
  RC_ASSERT(b.cols() > 0);
  return (a - b).colwise().norm().maxCoeff() / b.colwise().norm().maxCoeff();
}

}  // namespace lipofill::simulation
