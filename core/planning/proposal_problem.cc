#include "core/planning/proposal_problem.h"

#include <algorithm>
#include <cmath>

#include "core/base/units.h"

namespace lipofill::planning {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Pressure and lift are kept this far below their bounds, which shapes are true to.
constexpr double kMargin = 5e-4;
constexpr double kPerMl = kCubicMetresPerMillilitre;

double share_of_bound(double value, double bound) {
  return std::isfinite(bound) ? value / bound : 0.0;
}

}  // namespace

double FitState::excess(const ProposalBounds& bounds) const {
  return std::max({0.0, share_of_bound(volumes.sum(), bounds.max_total) - 1.0,
                   share_of_bound(pressure.maxCoeff(), bounds.max_pressure) - 1.0,
                   share_of_bound(max_lift, bounds.max_lift) - 1.0});
}

BoundedProblem linearise(const FitState& state, const VolumeSlopes& slopes, const SkinPoints& points,
                         const std::vector<SoughtZone>& zones, const ProposalBounds& bounds) {
  const auto n = static_cast<Index>(zones.size());
  const VectorXd weight = points.area.cwiseSqrt();
  BoundedProblem problem;
  problem.start = state.volumes / kPerMl;
  problem.matrix = kPerMl * (weight.asDiagonal() * slopes.of_distance(points, state.direction));
  problem.right_side = problem.matrix * problem.start - weight.cwiseProduct(state.distance);
  problem.low.resize(n);
  problem.high.resize(n);
  std::vector<VectorXd> rows;
  std::vector<double> limits;
  const auto limit = [&](const VectorXd& slope, double value, double bound) {
    rows.push_back(kPerMl * slope);
    limits.push_back((1.0 - kMargin) * bound - value + rows.back().dot(problem.start));
  };
  for (Index z = 0; z < n; ++z) {
    problem.low[z] = zones[static_cast<size_t>(z)].bounds.low / kPerMl;
    problem.high[z] = zones[static_cast<size_t>(z)].bounds.high / kPerMl;
    if (std::isfinite(bounds.max_pressure)) {
      limit(slopes.pressure().row(z).transpose(), state.pressure[z], bounds.max_pressure);
    }
  }
  if (std::isfinite(bounds.max_total)) {
    rows.push_back(VectorXd::Ones(n));
    limits.push_back(bounds.max_total / kPerMl);
  }
  if (std::isfinite(bounds.max_lift)) {
    // These are where each zone lifts most, and where the skin is highest now.
    std::vector<Index> crowns(zones.size() + 1);
    state.skin.colwise().norm().maxCoeff(&crowns.back());
    for (size_t z = 0; z < zones.size(); ++z) slopes.skin()[z].colwise().norm().maxCoeff(&crowns[z]);
    for (const Index node : crowns) {
      const double lift = state.skin.col(node).norm();
      VectorXd slope(n);
      for (Index z = 0; z < n; ++z) {
        slope[z] = lift > 0.0 ? state.skin.col(node).dot(slopes.skin()[static_cast<size_t>(z)].col(node)) / lift : 0.0;
      }
      limit(slope, lift, bounds.max_lift);
    }
  }
  problem.slope.resize(static_cast<Index>(rows.size()), n);
  problem.limit.resize(problem.slope.rows());
  for (size_t row = 0; row < rows.size(); ++row) {
    problem.slope.row(static_cast<Index>(row)) = rows[row].transpose();
    problem.limit[static_cast<Index>(row)] = limits[row];
  }
  return problem;
}

}  // namespace lipofill::planning
