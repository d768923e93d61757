// The bounded step against all choices of which bounds and limits hold, one of which is the answer.

#include "core/planning/proposal_step.h"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <limits>
#include <random>

namespace lipofill::planning {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

BoundedProblem make_problem(unsigned seed, Eigen::Index n, Eigen::Index n_limits) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto fill = [&](auto& matrix) { matrix = matrix.unaryExpr([&](double) { return number(random); }); };
  BoundedProblem problem;
  problem.matrix.setZero(30, n);
  fill(problem.matrix);
  problem.matrix.array() += 0.5;  // columns that resemble each other, as those of zones side by side
  problem.right_side.setZero(30);
  fill(problem.right_side);
  problem.right_side = problem.right_side * 2.0 + problem.matrix * Eigen::VectorXd::Constant(n, 1.5);
  problem.low.setZero(n);
  problem.high.setConstant(n, 2.0);
  problem.slope.setZero(n_limits, n);
  fill(problem.slope);
  problem.slope = problem.slope.cwiseAbs();
  problem.limit.setConstant(n_limits, 1.0);
  problem.start.setConstant(n, 0.1);
  return problem;
}

/// The least |A x - b|^2 over all x that some choice of equalities gives and that break nothing.
Eigen::VectorXd solve_by_trying_all(const BoundedProblem& problem) {
  const Eigen::Index n = problem.matrix.cols();
  Eigen::MatrixXd rows(2 * n + problem.slope.rows(), n);
  rows << Eigen::MatrixXd::Identity(n, n), -Eigen::MatrixXd::Identity(n, n), problem.slope;
  Eigen::VectorXd limits(rows.rows());
  limits << problem.high, -problem.low, problem.limit;
  double least = kNone;
  Eigen::VectorXd best;
  for (unsigned choice = 0; choice < (1U << rows.rows()); ++choice) {
    std::vector<int> active;
    for (int row = 0; row < rows.rows(); ++row) {
      if ((choice >> row) & 1U) active.push_back(row);
    }
    const auto k = static_cast<Eigen::Index>(active.size());
    if (k > n) continue;
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + k, n + k);
    Eigen::VectorXd right(n + k);
    system.topLeftCorner(n, n) = problem.matrix.transpose() * problem.matrix;
    right.head(n) = problem.matrix.transpose() * problem.right_side;
    for (Eigen::Index a = 0; a < k; ++a) {
      system.block(n + a, 0, 1, n) = rows.row(active[static_cast<size_t>(a)]);
      system.block(0, n + a, n, 1) = rows.row(active[static_cast<size_t>(a)]).transpose();
      right[n + a] = limits[active[static_cast<size_t>(a)]];
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> factor(system);
    if (!factor.isInvertible()) continue;
    const Eigen::VectorXd x = factor.solve(right).head(n);
    if (((rows * x - limits).array() > 1e-9).any()) continue;
    const double value = (problem.matrix * x - problem.right_side).squaredNorm();
    if (value < least) {
      least = value;
      best = x;
    }
  }
  return best;
}

TEST(ProposalStep, IsTheBestOfAllChoicesOfActiveBounds) {
  int n_at_bounds = 0, n_at_limits = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    const BoundedProblem problem = make_problem(seed, 2 + seed % 3, 1 + seed % 3);
    const Eigen::VectorXd expected = solve_by_trying_all(problem);
    const auto found = solve_bounded(problem);
    ASSERT_TRUE(found.ok()) << found.status();
    EXPECT_LT((*found - expected).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_TRUE((found->array() >= problem.low.array()).all() && (found->array() <= problem.high.array()).all());
    n_at_bounds += static_cast<int>((expected.array() < 1e-9).count());
    n_at_limits += static_cast<int>(((problem.slope * expected - problem.limit).array() > -1e-9).count());
  }
  EXPECT_GT(n_at_bounds, 20) << "bounds were tried";
  EXPECT_GT(n_at_limits, 20) << "limits were tried";
}

TEST(ProposalStep, UnknownsThatDoTheSameStayNearTheStart) {
  BoundedProblem problem = make_problem(1, 2, 0);
  problem.matrix.col(1) = problem.matrix.col(0);
  problem.right_side = 2.4 * problem.matrix.col(0);
  problem.start << 0.2, 0.6;
  const auto found = solve_bounded(problem);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_NEAR(found->sum(), 2.4, 1e-5);
  EXPECT_NEAR((*found)[1] - (*found)[0], 0.4, 1e-3);
}

TEST(ProposalStep, HasTheSameBytesEveryTime) {
  const BoundedProblem problem = make_problem(7, 4, 3);
  EXPECT_EQ(*solve_bounded(problem), *solve_bounded(problem));
}

TEST(ProposalStep, RefusesBoundsThatAdmitNothing) {
  BoundedProblem problem = make_problem(1, 2, 0);
  problem.low[0] = 3.0;
  EXPECT_EQ(solve_bounded(problem).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace lipofill::planning
