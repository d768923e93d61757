#pragma once

#include <memory>
#include <vector>

#include "core/equilibrium/equilibrium.h"
#include "core/plan/plan_placement.h"
#include "core/simulation/simulation.h"

namespace lipofill::verification {

/// A plan's equilibrium with all that it stands on, by the parts of core/equilibrium alone.
class DirectCase {
 public:
  DirectCase(std::shared_ptr<const model::FaceModel> model, plan::SimulationSpec spec);

  /// The volumes that the pools hold once all is injected.
  equilibrium::PoolTarget target() const;
  equilibrium::Settled solve(double tolerance = 1e-3);
  equilibrium::Settled solve(const equilibrium::PoolTarget& target, double tolerance);

  const equilibrium::Pools& pools() const { return equilibrium_->pools(); }
  const mechanics::TissueSystem& system() const { return *system_; }
  const mechanics::StepCost& cost() const { return cost_; }
  /// Displacements of the skin's nodes [m].
  Eigen::Matrix3Xd skin(const equilibrium::Settled& settled) const;

 private:
  std::shared_ptr<const model::FaceModel> model_;
  plan::SimulationSpec spec_;
  plan::PlacedPlan placed_;
  mechanics::FilmCells cells_;
  mechanics::StepCost cost_;
  std::unique_ptr<mechanics::TissueSystem> system_;
  std::unique_ptr<mechanics::FilmGeometry> geometry_;
  std::unique_ptr<equilibrium::Equilibrium> equilibrium_;
};

/// The same plan in time steps until its skin has less than `left` to go [m], by the fall of its
/// speed.
std::unique_ptr<simulation::Simulation> step_until_at_rest(std::shared_ptr<const model::FaceModel> model,
                                                           plan::SimulationSpec spec, double left);

/// Displacements of the skin's nodes [m].
Eigen::Matrix3Xd skin_of(const simulation::Simulation& simulation);

}  // namespace lipofill::verification
