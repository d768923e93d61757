#include "core/planning/proposal_step.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "absl/strings/str_cat.h"

namespace lipofill::planning {
namespace {

/// Unknowns that nothing else decides are held by this, of the largest column of A.
constexpr double kHold = 1e-7;
/// Weights of broken limits, of the largest column of A: each begins where the last one ended.
constexpr double kWeights[] = {1e1, 1e2, 1e3, 1e4};
constexpr int kMaxIterations = 500;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A x - b.
class LinearResidual : public ceres::CostFunction {
 public:
  LinearResidual(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right_side)
      : matrix_(matrix), right_side_(right_side) {
    set_num_residuals(static_cast<int>(matrix.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(matrix.cols()));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(parameters[0], matrix_.cols());
    Eigen::Map<Eigen::VectorXd>(residuals, matrix_.rows()) = matrix_ * x - right_side_;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[0], matrix_.rows(), matrix_.cols()) = matrix_;
    }
    return true;
  }

 private:
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd right_side_;
};

/// weight max(0, g x - limit), a row each.
class BrokenLimits : public ceres::CostFunction {
 public:
  BrokenLimits(const Eigen::MatrixXd& slope, const Eigen::VectorXd& limit, double weight)
      : slope_(slope), limit_(limit), weight_(weight) {
    set_num_residuals(static_cast<int>(slope.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(slope.cols()));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(parameters[0], slope_.cols());
    const Eigen::VectorXd over = slope_ * x - limit_;
    Eigen::Map<Eigen::VectorXd>(residuals, over.size()) = weight_ * over.cwiseMax(0.0);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<RowMajor> jacobian(jacobians[0], slope_.rows(), slope_.cols());
    jacobian.setZero();
    for (Eigen::Index row = 0; row < over.size(); ++row) {
      if (over[row] > 0.0) jacobian.row(row) = weight_ * slope_.row(row);
    }
    return true;
  }

 private:
  Eigen::MatrixXd slope_;
  Eigen::VectorXd limit_;
  double weight_;
};

ceres::Solver::Options pinned_options() {
  ceres::Solver::Options options;
  options.minimizer_type = ceres::TRUST_REGION;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = ceres::DENSE_QR;
  options.dense_linear_algebra_library_type = ceres::EIGEN;
  options.num_threads = 1;
  options.max_num_iterations = kMaxIterations;
  options.initial_trust_region_radius = 1e8;
  options.function_tolerance = 0.0;
  options.gradient_tolerance = 1e-15;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  options.max_num_consecutive_invalid_steps = 50;
  return options;
}

absl::Status check_sizes(const BoundedProblem& problem) {
  const Eigen::Index n = problem.matrix.cols();
  if (problem.right_side.size() != problem.matrix.rows() || problem.low.size() != n || problem.high.size() != n ||
      problem.start.size() != n || problem.slope.rows() != problem.limit.size() ||
      (problem.slope.rows() > 0 && problem.slope.cols() != n)) {
    return absl::InvalidArgumentError("the sizes of a bounded problem disagree");
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    if (!(problem.low[k] <= problem.high[k])) {
      return absl::InvalidArgumentError(
          absl::StrCat("bounds admit nothing: ", problem.low[k], " to ", problem.high[k]));
    }
  }
  return absl::OkStatus();
}

/// The same problem with as many rows as unknowns, and a little that holds them at the start.
struct Compressed {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right_side;
  double size = 0.0;  ///< of the largest column
};

Compressed compress(const BoundedProblem& problem) {
  const Eigen::Index m = problem.matrix.rows(), n = problem.matrix.cols();
  const double size = std::max(problem.matrix.colwise().norm().maxCoeff(), std::numeric_limits<double>::min());
  Eigen::MatrixXd both(m + n, n + 1);
  both << problem.matrix, problem.right_side,  //
      kHold * size * Eigen::MatrixXd::Identity(n, n), kHold * size * problem.start;
  const Eigen::MatrixXd triangle =
      Eigen::HouseholderQR<Eigen::MatrixXd>(both).matrixQR().topRows(n + 1).triangularView<Eigen::Upper>();
  return {triangle.topLeftCorner(n, n), triangle.topRightCorner(n, 1), size};
}

struct Limits {
  Eigen::MatrixXd slope;
  Eigen::VectorXd limit;
};

/// Bounds of single unknowns and limits of several alike, with rows of length 1.
Limits collect_limits(const BoundedProblem& problem) {
  const Eigen::Index n = problem.matrix.cols(), k = problem.slope.rows();
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> limits;
  for (Eigen::Index unknown = 0; unknown < n; ++unknown) {
    if (std::isfinite(problem.high[unknown])) {
      rows.emplace_back(Eigen::VectorXd::Unit(n, unknown));
      limits.push_back(problem.high[unknown]);
    }
    rows.emplace_back(-Eigen::VectorXd::Unit(n, unknown));
    limits.push_back(-problem.low[unknown]);
  }
  for (Eigen::Index row = 0; row < k; ++row) {
    const double length = std::max(problem.slope.row(row).norm(), std::numeric_limits<double>::min());
    rows.emplace_back(problem.slope.row(row).transpose() / length);
    limits.push_back(problem.limit[row] / length);
  }
  Limits all{Eigen::MatrixXd(static_cast<Eigen::Index>(rows.size()), n), Eigen::VectorXd(rows.size())};
  for (size_t row = 0; row < rows.size(); ++row) {
    all.slope.row(static_cast<Eigen::Index>(row)) = rows[row].transpose();
    all.limit[static_cast<Eigen::Index>(row)] = limits[row];
  }
  return all;
}

}  // namespace

absl::StatusOr<Eigen::VectorXd> solve_bounded(const BoundedProblem& problem) {
  if (const absl::Status sizes = check_sizes(problem); !sizes.ok()) return sizes;
  const Compressed compressed = compress(problem);
  const Limits limits = collect_limits(problem);
  Eigen::VectorXd x = problem.start.cwiseMax(problem.low).cwiseMin(problem.high);
  for (const double weight : kWeights) {
    ceres::Problem ceres_problem;
    ceres_problem.AddResidualBlock(
        new LinearResidual(compressed.matrix / compressed.size, compressed.right_side / compressed.size), nullptr,
        x.data());
    ceres_problem.AddResidualBlock(new BrokenLimits(limits.slope, limits.limit, weight), nullptr, x.data());
    ceres::Solver::Summary summary;
    ceres::Solve(pinned_options(), &ceres_problem, &summary);
    if (!summary.IsSolutionUsable()) return absl::InternalError(summary.message);
  }
  return Eigen::VectorXd(x.cwiseMax(problem.low).cwiseMin(problem.high));
}

}  // namespace lipofill::planning
