#include "core/equilibrium/equilibrium.h"

#include <algorithm>
#include <utility>

namespace lipofill::equilibrium {
namespace {

/// A part of the volume smaller than this is not tried any more: the path ends.
constexpr double kLeastPart = 1.0 / 64.0;
/// Derivatives are taken where forces balance to this: what a modulus does is small beside the
/// shape.
constexpr double kDerivativeTolerance = 1e-5;
/// Forces are linear in Young's moduli: a difference over this share is exact but for round-off.
constexpr double kModulusShare = 0.01;

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
      system_(system),
      factor_(std::move(factor)),
      balance_(system, films, cells, pools_, geometry, load),
      response_(*factor_, pools_) {}

Settled Equilibrium::find(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance) {
  factor_->begin();
  response_.forget();
  Solver solver(balance_, response_, pools_);
  const Eigen::VectorXd rest = rest_volume();
  Shape good = Shape::at_rest(system_.tissue().n_dofs(), pools_);
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
  last_ = std::move(good);
  last_target_ = std::move(reached);
  last_springs_ = springs;
  is_from_rest_ = true;
  return settled;
}

Settled Equilibrium::follow(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance) {
  if (last_.n_rows() == 0 || !mechanics::is_same(springs, last_springs_)) return find(target, springs, tolerance);
  Solver solver(balance_, response_, pools_);
  Shape shape = last_;
  if (!solver.solve(target, springs, tolerance, shape)) return find(target, springs, tolerance);
  Settled settled = describe(target, shape, 1.0);
  settled.cost = solver.cost();
  last_ = std::move(shape);
  last_target_ = target;
  is_from_rest_ = false;
  return settled;
}

void Equilibrium::hold_here() {
  held_ = last_;
  held_target_ = last_target_;
  is_held_ = false;
  return_to_held();
}

Settled Equilibrium::find_from_held(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance) {
  last_ = held_;
  last_target_ = held_target_;
  Settled settled = follow(target, springs, tolerance);
  is_held_ = settled.cost.factors == 0 && !is_from_rest_;
  return settled;
}

void Equilibrium::return_to_held() {
  last_ = held_;
  last_target_ = held_target_;
  if (std::exchange(is_held_, true)) return;
  factor_->begin();
  balance_.bring_to(held_, last_springs_);
  response_.renew(balance_, last_springs_);
}

std::vector<std::optional<Sensitivity>> Equilibrium::differentiate_by_volume() {
  const Shape& base = refine_last();
  std::vector<std::optional<Sensitivity>> all;
  for (int pool = 0; pool < pools_.n(); ++pool) {
    all.push_back(differentiate(
        base, {Eigen::VectorXd::Zero(base.displacement.size()), Eigen::VectorXd::Unit(base.n_rows(), pool)}));
  }
  return all;
}

std::vector<std::optional<Sensitivity>> Equilibrium::differentiate_by_modulus() {
  const Shape& base = refine_last();
  std::vector<std::optional<Sensitivity>> all;
  for (int layer = 0; layer < system_.n_layers(); ++layer) {
    const auto force = differentiate_force(base, layer);
    if (force) {
      all.push_back(differentiate(base, {*force, Eigen::VectorXd::Zero(base.n_rows())}));
    } else {
      all.emplace_back();
    }
  }
  return all;
}

bool Equilibrium::has_same_unknowns(const Equilibrium& other) const {
  return pools_.of_cell == other.pools_.of_cell &&
         system_.tissue().dof_of_component() == other.system_.tissue().dof_of_component();
}

std::optional<Sensitivity> Equilibrium::differentiate_towards(Equilibrium& beside, double step) {
  if (!has_same_unknowns(beside)) return {};
  const Shape& base = refine_last();
  beside.balance_.bring_to(base, last_springs_);
  LoadChange change;
  change.force = (beside.balance_.force() - balance_.force()) / step;
  change.volume = base.reduce(pools_, balance_.gap() - beside.balance_.gap()) / step;
  // What cells hold at rest is as much as their walls are large; what was injected is the same.
  change.volume.head(pools_.n()) += (beside.rest_volume() - rest_volume()) / step;
  return differentiate(base, change);
}

/// Brings the last shape closer to balance where that can be, for all derivatives at it. The
/// balance is there.
const Shape& Equilibrium::refine_last() {
  Shape refined = last_;
  Solver solver(balance_, response_, pools_);
  if (solver.solve(last_target_, last_springs_, kDerivativeTolerance, refined)) last_ = std::move(refined);
  balance_.bring_to(last_, last_springs_);
  return last_;
}

/// dr/d ln E of a layer.
std::optional<Eigen::VectorXd> Equilibrium::differentiate_force(const Shape& at, int layer) {
  const Eigen::VectorXd force = balance_.force();
  const Eigen::VectorXd as_they_are = Eigen::VectorXd::Ones(system_.n_layers());
  for (const double share : {kModulusShare, -kModulusShare}) {  // a modulus may be at its bound
    const Eigen::VectorXd factors = as_they_are + share * Eigen::VectorXd::Unit(system_.n_layers(), layer);
    if (!system_.scale_moduli(factors).ok()) continue;
    balance_.bring_to(at, last_springs_);
    const Eigen::VectorXd beside = balance_.force();
    system_.scale_moduli(as_they_are).IgnoreError();  // they were good before
    balance_.bring_to(at, last_springs_);
    return (beside - force) / share;
  }
  return {};
}

std::optional<Sensitivity> Equilibrium::differentiate(const Shape& at, const LoadChange& change) {
  const auto tangent = find_tangent(balance_, response_, pools_, at, last_springs_, change);
  if (!tangent) return {};
  Sensitivity found;
  found.displacement = Eigen::Matrix3Xd::Zero(3, system_.rest_positions().cols());
  system_.add_displacement(tangent->displacement, found.displacement);
  found.pool_head = tangent->pressure.head(pools_.n());
  return found;
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
