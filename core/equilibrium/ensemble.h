#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/equilibrium/equilibrium.h"

namespace lipofill::equilibrium {

/// The change says what a member of an ensemble differs in from the nominal plan.
struct MemberChange {
  Eigen::VectorXd moduli;   ///< Young's modulus of each layer over the nominal one (n_layers)
  Eigen::VectorXd volumes;  ///< of each pool, as the cells count it [m3]
  /// Tissue of another thickness with the same nodes and cells, or null: the nominal tissue.
  Equilibrium* tissue = nullptr;
};

/// Settled shapes of plans that differ from a nominal one in volumes, stiffness and thickness. All
/// go on from the nominal shape, moved by what its tangent tells of the change, with its factor, so
/// that a member costs iterations alone; one that needs a factor of its own has it, and the nominal
/// one is made again. A member depends on its change and on the nominal plan, never on the members
/// before or beside it. Checked by tests/unit/equilibrium/ensemble_test.cc.
class Ensemble {
 public:
  /// Finds the nominal shape, and factors and differentiates there.
  /// @param equilibrium  nobody else asks anything of it meanwhile; it outlives the ensemble
  Ensemble(Equilibrium& equilibrium, const PoolTarget& nominal, const Eigen::VectorXd& springs, double tolerance);

  /// The nominal shape; members are found only where it is whole.
  const Settled& nominal() const { return nominal_; }
  /// The shapes of members, side by side, at a fraction of the cost of one after the other. A shape
  /// that is not found beside the nominal one is found from rest, as Equilibrium::find.
  /// INVALID_ARGUMENT where a modulus is out of its bounds, or a tissue has other nodes.
  std::vector<absl::StatusOr<Settled>> find(const std::vector<MemberChange>& changes);

 private:
  struct Member;

  void differentiate();
  void begin(const MemberChange& change, Member& member) const;
  void approach(std::vector<Member>& members);
  bool measure(Member& member);
  void finish(Member& member);

  Equilibrium& equilibrium_;
  Parts& parts_;
  const double tolerance_;
  Settled nominal_;
  Found held_;                       ///< the nominal shape
  std::vector<Tangent> by_modulus_;  ///< of ln E of each layer
  std::vector<Tangent> by_volume_;   ///< of each pool
};

}  // namespace lipofill::equilibrium
