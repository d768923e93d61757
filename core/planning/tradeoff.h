#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "core/planning/proposal_case.h"
#include "core/planning/proposal_fit.h"

namespace lipofill::planning {

/// A trade-off is what is reached with some volumes.
struct TradeOff {
  Eigen::VectorXd volumes;   ///< a zone [m3]
  Eigen::VectorXd pressure;  ///< [Pa]
  std::vector<Bound> bound;
  double rms = 0.0;  ///< of the skin that lacks something [m]
  double p95 = 0.0;
  double total() const { return volumes.sum(); }
  double max_pressure() const { return pressure.maxCoeff(); }
};

TradeOff make_trade_off(const ProposalCase& face, const FittedVolumes& fitted);

/// True where one is in nothing worse than the other (rms, total volume, largest pressure) and in
/// something better.
bool dominates(const TradeOff& one, const TradeOff& other);

/// The curve of closeness against volume and pressure, from the least volume to the most: what was
/// fitted, and the best that parts of its total volume and, with several zones, of its largest
/// pressure reach. Points that another one dominates are left out; what was fitted never is.
/// @param n_points  wanted on the curve, with what was fitted
/// @param cost      out: added to
/// Checked by tests/unit/planning/proposal_test.cc.
absl::StatusOr<std::vector<TradeOff>> trace_trade_off(const ProposalCase& face, VolumeFit& fit,
                                                      const FittedVolumes& fitted, const ProposalBounds& bounds,
                                                      int n_points, const Unwanted& unwanted, ProposalCost& cost);

}  // namespace lipofill::planning
