#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/mechanics/held_factor.h"
#include "core/mechanics/tissue_system.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::mechanics {

/// The tissue of the small plan, with its one film.
struct SmallSystem {
  explicit SmallSystem(std::shared_ptr<const model::FaceModel> face = simulation::make_small_model())
      : model(std::move(face)) {}

  std::shared_ptr<const model::FaceModel> model;
  plan::SimulationSpec spec = simulation::make_small_plan();
  std::vector<plan::FilmLayout> films{*plan::place_film(*model, spec.films[0])};
  FilmCells cells = number_cells(films);
  StepCost cost;
  std::unique_ptr<TissueSystem> system = *TissueSystem::create(*model, films, cells, spec, cost);
  std::unique_ptr<HeldFactor> factor = *HeldFactor::create(*model, *system, cost);
  Eigen::VectorXd springs;  ///< none

  /// Positions bent by up to `size` [m], so that no symmetry hides a mistake.
  Eigen::Matrix3Xd bent(double size) const {
    Eigen::Matrix3Xd x = system->rest_positions();
    for (Eigen::Index n = 0; n < x.cols(); ++n) x(2, n) += size * std::sin(80.0 * x(0, n)) * std::cos(60.0 * x(1, n));
    return x;
  }
  SimulationState state_at(const Eigen::Matrix3Xd& x) const {
    SimulationState state;
    state.positions = x;
    state.velocities.setZero(3, x.cols());
    return state;
  }
};

}  // namespace lipofill::mechanics
