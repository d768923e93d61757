#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace lipofill::planning {

/// A linear least-squares problem within bounds, of a few unknowns x near 1:
///
///     minimise |A x - b|^2   with   low <= x <= high,   G x <= limit
///
struct BoundedProblem {
  Eigen::MatrixXd matrix;      ///< A (m, n)
  Eigen::VectorXd right_side;  ///< b (m)
  Eigen::VectorXd low, high;   ///< (n)
  Eigen::MatrixXd slope;       ///< G (k, n)
  Eigen::VectorXd limit;       ///< (k)
  Eigen::VectorXd start;       ///< (n)
};

/// Solves it with Ceres. What bounds and limits are broken by counts by its square, weighted more
/// and more until they hold to 1e-6; x is then put within its own bounds. Ceres' bounds of
/// parameters are not used: where one of them holds, its steps cut the others short, and end a few
/// percent from the answer. Where several x are as good, as with zones that do the same, it is the
/// one nearest to the start.
/// One thread and Eigen's dense algebra: the same problem has the same bytes for an answer.
/// INVALID_ARGUMENT where low > high or the sizes disagree; INTERNAL where Ceres fails. That no x
/// is within the limits shows in the answer. Checked by tests/unit/planning/proposal_step_test.cc
/// against every choice of active bounds.
absl::StatusOr<Eigen::VectorXd> solve_bounded(const BoundedProblem& problem);

}  // namespace lipofill::planning
