// Ways to the coupled step over CHOLMOD's factors.

#include <algorithm>
#include <utility>

#include "absl/status/status.h"
#include "tests/bench/block_matrix.h"
#include "tests/bench/cholmod_factor.h"
#include "tests/bench/dense_cholesky.h"
#include "tests/bench/phase_clock.h"
#include "tests/bench/pressure_cg.h"
#include "tests/bench/route.h"

namespace lipofill::bench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = CholmodFactor::Kind;

constexpr int kMostColumns = 1000;
constexpr int kSampledColumns = 256;

/// C column by column, C = B S^-1 B^T: the paper's way. `block` of them go through the factor side
/// by side. Of more than kMostColumns only kSampledColumns are done, evenly spread, and the others
/// are counted by their mean.
class ColumnwiseCompliance : public Route {
 public:
  ColumnwiseCompliance(const LinearStep& step, int block) : factor_(step.s, Kind::kSupernodal), block_(block) {}

  absl::StatusOr<RouteRun> run(const LinearStep& step) override {
    RouteRun result;
    PhaseClock clock;
    if (const absl::Status status = factor_.factorise(step.s); !status.ok()) return status;
    clock.done("factor");
    const int n = step.n_cells();
    const int n_done = n > kMostColumns ? kSampledColumns : n;
    MatrixXd compliance = MatrixXd::Zero(n, n);
    const Eigen::SparseMatrix<double> forces = step.b.transpose();
    for (int first = 0; first < n_done; first += block_) add_columns(step, forces, first, n_done, compliance);
    clock.done("compliance");
    result.is_complete = n_done == n;
    // A sample of C stands in for the whole: a dense factorisation takes the same time whatever the
    // values.
    if (!result.is_complete) compliance.diagonal().setConstant(compliance.cwiseAbs().maxCoeff() * n);
    const VectorXd response = step.b * VectorXd(factor_.solve(step.f));
    clock.done("solve");
    result.answer.pressure = DenseCholesky(compliance + MatrixXd(step.j)).solve(step.d - response);
    clock.done("pressure");
    result.answer.displacement = factor_.solve(step.f + step.b.transpose() * result.answer.pressure);
    clock.done("displacement");
    result.phases = clock.take();
    for (auto& [phase, span] : result.phases) {
      if (phase == "compliance") span = static_cast<double>(n) / n_done * span;
    }
    return result;
  }

 private:
  void add_columns(const LinearStep& step, const Eigen::SparseMatrix<double>& forces, int first, int n_done,
                   MatrixXd& compliance) {
    const int count = std::min(block_, n_done - first);
    MatrixXd right(step.n_dofs(), count);
    std::vector<int> cells(count);
    for (int k = 0; k < count; ++k) {
      cells[k] = static_cast<int>(static_cast<int64_t>(first + k) * step.n_cells() / n_done);
      right.col(k) = forces.col(cells[k]);
    }
    const MatrixXd columns = step.b * factor_.solve(right);
    for (int k = 0; k < count; ++k) compliance.col(cells[k]) = columns.col(k);
  }

  CholmodFactor factor_;
  int block_;
};

/// Conjugate gradients on (J + C) p = d - B S^-1 f, a solve with S an iteration.
class PressureGradients : public Route {
 public:
  explicit PressureGradients(const LinearStep& step) : factor_(step.s, Kind::kSupernodal), cg_(step) {}

  absl::StatusOr<RouteRun> run(const LinearStep& step) override {
    RouteRun result;
    PhaseClock clock;
    if (const absl::Status status = factor_.factorise(step.s); !status.ok()) return status;
    clock.done("factor");
    const VectorXd response = step.b * VectorXd(factor_.solve(step.f));
    clock.done("solve");
    result.answer.pressure = cg_.solve(step, factor_, step.d - response);
    result.iterations = cg_.iterations();
    clock.done("pressure");
    result.answer.displacement = factor_.solve(step.f + step.b.transpose() * result.answer.pressure);
    clock.done("displacement");
    result.phases = clock.take();
    return result;
  }

 private:
  CholmodFactor factor_;
  PressureCg cg_;
};

/// One Cholesky factorisation of [S B^T; B e I] with the pressures last, e above the largest
/// eigenvalue of C: its last block gives C = e I - L22 L22^T.
class AugmentedCholesky : public Route {
 public:
  explicit AugmentedCholesky(const LinearStep& step)
      : corner_(scaled_identity(step.n_cells(), 1.0)),
        matrix_(step, corner_),
        factor_(matrix_.lower(), Kind::kSupernodal, order_with_more_last(step.s, step.n_cells())) {
    for (int column = 0; column < step.n_dofs(); ++column) {
      const double stiffness = step.s.coeff(column, column);
      for (Eigen::SparseMatrix<double>::InnerIterator it(step.b, column); it; ++it) {
        shift_ = std::max(shift_, it.value() * it.value() / stiffness);
      }
    }
  }

  absl::StatusOr<RouteRun> run(const LinearStep& step) override {
    const bool is_first = n_runs_++ == 0;
    for (int tries = 0; is_first && tries < kMaxShiftTries && !factorise(step).ok(); ++tries) shift_ *= kShiftGrowth;
    RouteRun result;
    PhaseClock clock;
    if (const absl::Status status = factorise(step); !status.ok()) return status;
    clock.done("factor");
    const MatrixXd compliance = extract_compliance(step);
    clock.done("compliance");
    VectorXd right(step.n_dofs() + step.n_cells());
    right << step.f, VectorXd::Zero(step.n_cells());
    const VectorXd q = VectorXd(factor_.solve(right)).tail(step.n_cells());
    const VectorXd response = compliance * q - shift_ * q;
    clock.done("solve");
    const VectorXd pressure = DenseCholesky(compliance + MatrixXd(step.j)).solve(step.d - response);
    clock.done("pressure");
    right.tail(step.n_cells()) = response + compliance * pressure - shift_ * pressure;
    result.answer = {VectorXd(factor_.solve(right)).head(step.n_dofs()), pressure};
    clock.done("displacement");
    result.phases = clock.take();
    return result;
  }

 private:
  static constexpr int kMaxShiftTries = 40;
  static constexpr double kShiftGrowth = 4.0;

  absl::Status factorise(const LinearStep& step) {
    corner_.coeffs().setConstant(shift_);
    matrix_.fill(step, corner_);
    return factor_.factorise(matrix_.lower());
  }

  MatrixXd extract_compliance(const LinearStep& step) const {
    const int n = step.n_cells();
    const MatrixXd block = factor_.last_block(n);
    const std::vector<int> order = factor_.order();
    MatrixXd product = MatrixXd::Zero(n, n);
    product.selfadjointView<Eigen::Lower>().rankUpdate(block);
    MatrixXd compliance(n, n);
    for (int b = 0; b < n; ++b) {
      for (int a = b; a < n; ++a) {
        const int row = order[step.n_dofs() + a] - step.n_dofs();
        const int column = order[step.n_dofs() + b] - step.n_dofs();
        compliance(row, column) = compliance(column, row) = (a == b ? shift_ : 0.0) - product(a, b);
      }
    }
    return compliance;
  }

  double shift_ = 0.0;
  int n_runs_ = 0;
  Eigen::SparseMatrix<double> corner_;
  BlockMatrix matrix_;
  CholmodFactor factor_;
};

/// CHOLMOD's L D L^T, column by column, of the quasi-definite matrix.
class SimplicialCholmod : public Route {
 public:
  explicit SimplicialCholmod(const LinearStep& step)
      : matrix_(step, lower_of_films(step, -1.0)),
        factor_(matrix_.lower(), Kind::kSimplicial, order_with_more_last(step.s, step.n_cells())) {}

  absl::StatusOr<RouteRun> run(const LinearStep& step) override {
    RouteRun result;
    PhaseClock clock;
    matrix_.fill(step, lower_of_films(step, -1.0));
    if (const absl::Status status = factor_.factorise(matrix_.lower()); !status.ok()) return status;
    clock.done("factor");
    VectorXd right(step.n_dofs() + step.n_cells());
    right << step.f, step.d;
    const VectorXd solution = factor_.solve(right);
    result.answer = {solution.head(step.n_dofs()), -solution.tail(step.n_cells())};
    clock.done("solve");
    result.phases = clock.take();
    return result;
  }

 private:
  BlockMatrix matrix_;
  CholmodFactor factor_;
};

template <typename R, typename... Arguments>
auto maker(Arguments... arguments) {
  return [arguments...](const LinearStep& step) -> absl::StatusOr<std::unique_ptr<Route>> {
    return std::make_unique<R>(step, arguments...);
  };
}

}  // namespace

std::vector<RouteKind> cholmod_routes() {
  return {
      {"augmented_cholesky", "CHOLMOD, supernodal, of [S B^T; B e I]; C from its last block; dense J + C",
       maker<AugmentedCholesky>()},
      {"paper_way", "CHOLMOD, supernodal, of S; C by one solve a film cell; dense J + C",
       maker<ColumnwiseCompliance>(1)},
      {"paper_way_in_blocks", "the same, 32 solves side by side", maker<ColumnwiseCompliance>(32)},
      {"cg_on_pressure", "CHOLMOD, supernodal, of S; conjugate gradients on J + C, preconditioned by J + R to 1e-10",
       maker<PressureGradients>()},
      {"cholmod_simplicial", "CHOLMOD, simplicial L D L^T of [S B^T; B -J]", maker<SimplicialCholmod>(), 1},
  };
}

}  // namespace lipofill::bench
