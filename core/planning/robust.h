#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "core/planning/proposal_fit.h"

namespace lipofill::planning {

/// The spread says how well the tissue is known, and what has to hold all the same;
/// lipofill.v1.TissueSpread in SI.
struct TissueSpread {
  double pressure_band = 0.0;  ///< settled pressures stay below it [Pa]
  double share = 0.95;         ///< of the members, those that do
  int members = 100;
  double modulus_spread = 0.2;  ///< standard deviation of ln E of each layer
};

/// This is what it takes that a plan holds.
struct Robustness {
  int members = 0;
  int members_below = 0;
  double quantile = 0.0;  ///< the pressure that the share of members stays below [Pa]
  int nominal_members_below = 0;
  double nominal_quantile = 0.0;
  FittedVolumes nominal;  ///< what was fitted to the tissue as the model has it
};

/// Factors of Young's moduli, a vector a member: exp(spread x), x normal, each layer on its own. A
/// Latin hypercube, so that few members fill the distribution evenly; the same for the same sizes.
/// Checked by tests/unit/planning/robust_test.cc.
std::vector<Eigen::VectorXd> draw_moduli(int n_layers, int members, double spread);

/// The smallest value that at least a share of the values do not exceed.
double quantile_of(const Eigen::VectorXd& values, double share);

/// Takes what was fitted to volumes whose settled pressure stays below the band in the share of the
/// members, by a tighter bound of the pressure of the tissue as the model has it: where a member's
/// pressure grows like the nominal one, so does their quantile, and a few fits find the bound.
/// FAILED_PRECONDITION, with figures, where no volumes do. The bound is set in `bounds`.
/// @param n_layers  of the model
/// @param fitted    of the fit, in and out; the fit is at it
/// @param cost      added to; members are not counted, which have no factor of their own
/// Checked by tests/unit/planning/robust_test.cc.
absl::StatusOr<Robustness> make_robust(VolumeFit& fit, int n_layers, const TissueSpread& spread, ProposalBounds& bounds,
                                       FittedVolumes& fitted, const Unwanted& unwanted, ProposalCost& cost);

}  // namespace lipofill::planning
