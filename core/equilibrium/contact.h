#pragma once

#include <Eigen/Core>
#include <limits>

#include "core/equilibrium/pools.h"
#include "core/equilibrium/shape.h"
#include "core/equilibrium/static_balance.h"

namespace lipofill::equilibrium {

/// The target says what the pools are to hold, and how low their pressure may be.
struct PoolTarget {
  Eigen::VectorXd volume;                                         ///< of each pool, as the cells count it [m3]
  double lowest_head = -std::numeric_limits<double>::infinity();  ///< the suction limit, negated [Pa]
};

/// Finds what each row's gap lacks [m3], for pools at the limit what their head lacks [Pa].
Eigen::VectorXd find_missing(const StaticBalance& balance, const Pools& pools, const PoolTarget& target,
                             const Shape& shape);

/// Computes what the pools lack of their volume in all, as a share of it; those at the limit lack
/// none.
double relative_lack(const Pools& pools, const PoolTarget& target, const Shape& shape, const Eigen::VectorXd& missing);

/// Brings the active sets of a shape in balance to what it says: a cell whose gap is negative
/// closes, a closed one that its contact pressure pulls at opens; a pool below the lowest head
/// comes to the limit, one there whose fat overfills its gap leaves it. Returns true when something
/// has changed.
/// Checked by tests/unit/equilibrium/contact_test.cc.
///
/// @param may_open  false: cells only close, so that the sets come to an end
bool update_active_sets(const StaticBalance& balance, const Pools& pools, const PoolTarget& target, bool may_open,
                        Shape& shape);

}  // namespace lipofill::equilibrium
