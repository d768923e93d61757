#include "core/equilibrium/ensemble.h"

#include <utility>

namespace lipofill::equilibrium {

Ensemble::Ensemble(Equilibrium& equilibrium, const PoolTarget& nominal, const Eigen::VectorXd& springs,
                   double tolerance)
    : equilibrium_(equilibrium), target_(nominal), springs_(springs), tolerance_(tolerance) {
  nominal_ = equilibrium_.find(nominal, springs, tolerance);
  if (nominal_.is_whole()) equilibrium_.hold_here();
}

absl::StatusOr<Settled> Ensemble::find(const MemberChange& change) {
  if (absl::Status set = equilibrium_.scale_moduli(change.moduli); !set.ok()) return set;
  PoolTarget target = target_;
  target.volume = change.volumes;
  Settled member = equilibrium_.find_from_held(target, springs_, tolerance_);
  const absl::Status back = equilibrium_.scale_moduli(Eigen::VectorXd::Ones(change.moduli.size()));
  if (!back.ok()) return back;
  equilibrium_.return_to_held();
  return member;
}

}  // namespace lipofill::equilibrium
