#pragma once

#include <Eigen/Core>

#include "core/equilibrium/equilibrium.h"

namespace lipofill::equilibrium {

/// What a member of an ensemble differs in from the nominal plan.
struct MemberChange {
  Eigen::VectorXd moduli;   ///< Young's modulus of each layer over the nominal one (n_layers)
  Eigen::VectorXd volumes;  ///< of each pool, as the cells count it [m3]
};

/// Settled shapes of plans that differ from a nominal one in volumes and stiffness. All go on from
/// the nominal shape with its factor, so that a member costs iterations alone; one that needs a
/// factor of its own has it, and the nominal one is made again. A member depends on its change and
/// on the nominal plan, never on the members before it.
/// Checked by tests/unit/equilibrium/ensemble_test.cc.
class Ensemble {
 public:
  /// Finds the nominal shape and factors there.
  /// @param equilibrium  nobody else asks anything of it meanwhile; it outlives the ensemble
  Ensemble(Equilibrium& equilibrium, const PoolTarget& nominal, const Eigen::VectorXd& springs, double tolerance);

  /// The nominal shape; members are found only where it is whole.
  const Settled& nominal() const { return nominal_; }
  /// The shape of a member. Where it is not found beside the nominal one it is found from rest, as
  /// Equilibrium::find. INVALID_ARGUMENT where a modulus is out of its bounds.
  absl::StatusOr<Settled> find(const MemberChange& change);

 private:
  Equilibrium& equilibrium_;
  const PoolTarget target_;
  const Eigen::VectorXd springs_;
  const double tolerance_;
  Settled nominal_;
};

}  // namespace lipofill::equilibrium
