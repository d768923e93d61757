#include "core/equilibrium/equilibrium.h"

#include <algorithm>
#include <utility>

namespace lipofill::equilibrium {
namespace {

/// A part of the volume smaller than this is not tried any more: the path ends.
constexpr double kLeastPart = 1.0 / 64.0;
/// A difference is taken over this share of a pool's volume, between shapes as exact as this.
constexpr double kDifferenceShare = 1e-3;
constexpr double kDifferenceTolerance = 1e-7;

}  // namespace

absl::StatusOr<std::unique_ptr<Equilibrium>> Equilibrium::create(const model::FaceModel& model,
                                                                 const std::vector<plan::FilmLayout>& films,
                                                                 const mechanics::FilmCells& cells,
                                                                 mechanics::TissueSystem& system,
                                                                 mechanics::FilmGeometry& geometry,
                                                                 const StaticLoad& load, mechanics::StepCost& cost) {
  auto factor = mechanics::TissueFactor::create(model, system, cost);
  if (!factor.ok()) return factor.status();
  return std::unique_ptr<Equilibrium>(
      new Equilibrium(find_pools(films, cells), *std::move(factor), films, cells, system, geometry, load));
}

Equilibrium::Equilibrium(Pools pools, std::unique_ptr<mechanics::TissueFactor> factor,
                         const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
                         mechanics::TissueSystem& system, mechanics::FilmGeometry& geometry, const StaticLoad& load)
    : pools_(std::move(pools)),
      factor_(std::move(factor)),
      balance_(system, films, cells, pools_, geometry, load),
      n_dofs_(system.tissue().n_dofs()) {}

Settled Equilibrium::find(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance) {
  factor_->begin();
  HeldResponse response(*factor_, pools_);
  Solver solver(balance_, response, pools_);
  const Eigen::VectorXd rest = rest_volume();
  Shape good = Shape::at_rest(n_dofs_, pools_);
  std::string reason;
  double share = 0.0;
  double part = 1.0;
  while (share < 1.0) {
    const double next = std::min(1.0, share + part);
    PoolTarget partial = target;
    if (next < 1.0) partial.volume = rest + next * (target.volume - rest);
    Shape shape = good;
    if (solver.solve(partial, springs, tolerance, shape)) {
      good = std::move(shape);
      share = next;
      part *= 2.0;
      continue;
    }
    reason = solver.reason();
    part *= 0.5;
    if (part < kLeastPart) break;
  }
  balance_.bring_to(good, springs);
  PoolTarget reached = target;
  if (share < 1.0) reached.volume = rest + share * (target.volume - rest);
  Settled settled = describe(reached, good, share);
  if (share < 1.0) settled.reason = reason;
  settled.cost = solver.cost();
  return settled;
}

std::vector<Eigen::Matrix3Xd> Equilibrium::differentiate(const PoolTarget& target, const Settled& settled,
                                                         const Eigen::VectorXd& springs) {
  factor_->begin();
  HeldResponse response(*factor_, pools_);
  Solver solver(balance_, response, pools_);
  Shape base = shape_of(settled, springs);
  if (!solver.solve(target, springs, kDifferenceTolerance, base)) return {};
  const Eigen::Matrix3Xd at_base = balance_.positions();
  std::vector<Eigen::Matrix3Xd> derivatives;
  for (int pool = 0; pool < pools_.n(); ++pool) {
    const double more = kDifferenceShare * target.volume[pool];
    PoolTarget beside = target;
    beside.volume[pool] += more;
    Shape shape = base;
    if (!solver.solve(beside, springs, kDifferenceTolerance, shape)) return {};
    derivatives.push_back((balance_.positions() - at_base) / more);
  }
  return derivatives;
}

/// The unknowns that a settled shape was made from.
Shape Equilibrium::shape_of(const Settled& settled, const Eigen::VectorXd& springs) {
  Shape shape = Shape::at_rest(n_dofs_, pools_);
  shape.displacement = balance_.displacement_to(settled.positions);
  shape.closed = settled.closed;
  shape.is_at_limit = settled.is_at_limit;
  shape.pressure.resize(pools_.n() + static_cast<Eigen::Index>(settled.closed.size()));
  shape.pressure.setZero();
  shape.pressure.head(pools_.n()) = settled.pool_head;
  balance_.bring_to(shape, springs);  // with the heads alone: what is more is contact
  for (size_t k = 0; k < settled.closed.size(); ++k) {
    const int cell = settled.closed[k];
    shape.pressure[pools_.n() + static_cast<Eigen::Index>(k)] =
        settled.cell_pressure[cell] - balance_.cell_pressure()[cell];
  }
  return shape;
}

Settled Equilibrium::describe(const PoolTarget& target, const Shape& shape, double share) const {
  Settled settled;
  settled.share = share;
  settled.positions = balance_.positions();
  settled.cell_volume = balance_.gap().cwiseMax(0.0);
  settled.cell_pressure = balance_.cell_pressure();
  settled.pool_volume = pools_.sum(settled.cell_volume);
  settled.pool_head = shape.pressure.head(pools_.n());
  settled.is_at_limit = shape.is_at_limit;
  for (int cell = 0; cell < pools_.n_cells(); ++cell) {
    // Exactly the limit, by which the void is known.
    const auto pool = static_cast<size_t>(pools_.of_cell[cell]);
    if (shape.is_at_limit[pool])
      settled.cell_pressure[cell] = std::min(settled.cell_pressure[cell], target.lowest_head);
  }
  settled.fat_volume = target.volume;
  settled.closed = shape.closed;
  settled.force_error = balance_.relative_force();
  settled.is_double = factor_->is_double();
  return settled;
}

}  // namespace lipofill::equilibrium
