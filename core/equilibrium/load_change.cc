#include "core/equilibrium/load_change.h"

#include <utility>

#include "core/equilibrium/solver.h"

namespace lipofill::equilibrium {
namespace {

/// Derivatives are taken where forces balance to this.
constexpr double kDerivativeTolerance = 5e-5;
/// Forces are linear in Young's moduli: a difference over this share is exact but for round-off.
constexpr double kModulusShare = 0.01;

}  // namespace

bool have_same_unknowns(const Parts& a, const Parts& b) {
  return a.pools.of_cell == b.pools.of_cell &&
         a.system.tissue().dof_of_component() == b.system.tissue().dof_of_component();
}

void factor_at(Parts& parts, const Found& found) {
  parts.factor->begin();
  parts.balance.bring_to(found.shape, found.springs);
  parts.response.renew(parts.balance, found.springs);
}

void refine(Parts& parts, Found& found) {
  Shape refined = found.shape;
  Solver solver(parts.balance, parts.response, parts.pools);
  if (solver.solve(found.target, found.springs, kDerivativeTolerance, refined)) found.shape = std::move(refined);
  parts.balance.bring_to(found.shape, found.springs);
}

LoadChange change_by_volume(const Found& found, int pool) {
  return {Eigen::VectorXd::Zero(found.shape.displacement.size()), Eigen::VectorXd::Unit(found.shape.n_rows(), pool)};
}

std::optional<LoadChange> change_by_modulus(Parts& parts, const Found& found, int layer) {
  const Eigen::VectorXd as_they_are = parts.system.moduli();
  const Eigen::VectorXd force = parts.balance.force();
  std::optional<LoadChange> change;
  for (const double share : {kModulusShare, -kModulusShare}) {
    Eigen::VectorXd factors = as_they_are;
    factors[layer] *= 1.0 + share;
    if (change || !parts.system.scale_moduli(factors).ok()) continue;
    parts.balance.bring_to(found.shape, found.springs);
    change = LoadChange{(parts.balance.force() - force) / share, Eigen::VectorXd::Zero(found.shape.n_rows())};
  }
  parts.system.scale_moduli(as_they_are).IgnoreError();  // they were good before
  parts.balance.bring_to(found.shape, found.springs);
  return change;
}

std::optional<LoadChange> change_towards(Parts& parts, const Found& found, Parts& beside, double step) {
  if (!have_same_unknowns(parts, beside)) return {};
  beside.balance.bring_to(found.shape, found.springs);
  LoadChange change;
  change.force = (beside.balance.force() - parts.balance.force()) / step;
  change.volume = found.shape.reduce(parts.pools, parts.balance.gap() - beside.balance.gap()) / step;
  // What cells hold at rest is as much as their walls are large; what was injected is the same.
  change.volume.head(parts.pools.n()) +=
      parts.pools.sum(beside.balance.rest_volume() - parts.balance.rest_volume()) / step;
  return change;
}

}  // namespace lipofill::equilibrium
