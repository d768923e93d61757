#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/geometry/default_size.h"
#include "core/simulation/simulation.h"
#include "tests/verification/coupling/jaw_case.h"

namespace lipofill::verification {

/// A plan at rest on a grid of its own.
struct RefinedResult {
  std::unique_ptr<simulation::Simulation> simulation;  ///< null where it could not be had
  double lift = 0.0;                                   ///< of the skin, at most [m]
  double pressure = 0.0;                               ///< mean of the first zone [Pa]
  int n_xi = 0;
  int n_eta = 0;
};

/// What is asserted of a plan. All plans aim at the figures below;
/// core/doc/decisions/030-convergence-of-whole-plans.md has those that miss them.
struct RefinementBounds {
  double lift = 0.015;     ///< error at the size that ships, against the finest grid, as a share
  double pressure = 0.03;  ///< the same of the pressure
  double order = 1.5;      ///< least, of both
  /// An order that is reported and not asserted.
  static constexpr double kNoOrder = -10.0;
};

/// The plan at rest with `refinement` times as many hexahedra along both directions of the chart as
/// `ships` has, film cells two of them wide, and elements through the layers as their widths ask
/// for.
/// @param ships  divisions of the plan as it ships, even numbers
RefinedResult settle_refined(const JawPlan& plan, const geometry::GridSize& ships, double refinement);

/// Distance of the displacements of two skins that 95 of 100 nodes of the coarser one do not exceed
/// [mm].
double skin_difference(const RefinedResult& coarse, const RefinedResult& fine);

/// Records what refinement makes of a plan: the order of lift and pressure, from what changes from
/// grid to grid, and how far the size that ships is from the finest grid.
/// @param refinements  growing, with 1
void record_refinement(const std::string& name, const JawPlan& plan, const geometry::GridSize& ships,
                       const std::vector<double>& refinements, const RefinementBounds& bounds);

}  // namespace lipofill::verification
