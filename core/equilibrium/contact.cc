#include "core/equilibrium/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lipofill::equilibrium {
namespace {

/// A gap less negative than this share of the fullest cell's is round-off.
constexpr double kRoundOff = 1e-9;

/// The closed cells that stay so, and those that close, ascending, with their contact pressures.
bool update_closed_cells(const StaticBalance& balance, const Pools& pools, bool may_open, Shape& shape) {
  Eigen::VectorXd contact = Eigen::VectorXd::Constant(pools.n_cells(), -1.0);  // -1: open
  bool has_changed = false;
  for (size_t k = 0; k < shape.closed.size(); ++k) {
    const double pressure = shape.pressure[pools.n() + static_cast<Eigen::Index>(k)];
    const bool opens = pressure < 0.0 && may_open;
    has_changed = has_changed || opens;
    if (!opens) contact[shape.closed[k]] = std::max(pressure, 0.0);
  }
  const double least = -kRoundOff * balance.gap().cwiseAbs().maxCoeff();
  for (int cell = 0; cell < pools.n_cells(); ++cell) {
    const bool was_closed = std::binary_search(shape.closed.begin(), shape.closed.end(), cell);
    if (was_closed || balance.gap()[cell] >= least) continue;
    contact[cell] = 0.0;
    has_changed = true;
  }
  if (!has_changed) return false;
  shape.closed.clear();
  for (int cell = 0; cell < pools.n_cells(); ++cell) {
    if (contact[cell] >= 0.0) shape.closed.push_back(cell);
  }
  shape.pressure.conservativeResize(pools.n() + static_cast<Eigen::Index>(shape.closed.size()));
  for (size_t k = 0; k < shape.closed.size(); ++k) {
    shape.pressure[pools.n() + static_cast<Eigen::Index>(k)] = contact[shape.closed[k]];
  }
  return true;
}

bool update_limits(const StaticBalance& balance, const Pools& pools, const PoolTarget& target, Shape& shape) {
  const Eigen::VectorXd gap = pools.sum(balance.gap());
  bool has_changed = false;
  for (int pool = 0; pool < pools.n(); ++pool) {
    char& is_at_limit = shape.is_at_limit[static_cast<size_t>(pool)];
    const bool comes = is_at_limit == 0 && shape.pressure[pool] < target.lowest_head;
    const bool leaves = is_at_limit == 1 && gap[pool] < target.volume[pool];
    if (comes) {
      is_at_limit = 1;
      shape.pressure[pool] = target.lowest_head;
    }
    if (leaves) is_at_limit = 0;
    has_changed = has_changed || comes || leaves;
  }
  return has_changed;
}

}  // namespace

Eigen::VectorXd find_missing(const StaticBalance& balance, const Pools& pools, const PoolTarget& target,
                             const Shape& shape) {
  Eigen::VectorXd missing = -shape.reduce(pools, balance.gap());
  missing.head(pools.n()) += target.volume;
  for (int pool = 0; pool < pools.n(); ++pool) {
    if (shape.is_at_limit[static_cast<size_t>(pool)]) missing[pool] = target.lowest_head - shape.pressure[pool];
  }
  return missing;
}

double relative_lack(const Pools& pools, const PoolTarget& target, const Shape& shape, const Eigen::VectorXd& missing) {
  double lacking = 0.0;
  for (int pool = 0; pool < pools.n(); ++pool) {
    if (!shape.is_at_limit[static_cast<size_t>(pool)]) lacking += std::abs(missing[pool]);
  }
  return lacking / std::max(target.volume.cwiseAbs().sum(), std::numeric_limits<double>::min());
}

bool update_active_sets(const StaticBalance& balance, const Pools& pools, const PoolTarget& target, bool may_open,
                        Shape& shape) {
  const bool limits_change = update_limits(balance, pools, target, shape);
  const bool cells_change = update_closed_cells(balance, pools, may_open, shape);
  return limits_change || cells_change;
}

}  // namespace lipofill::equilibrium
