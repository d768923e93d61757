// Ways to the coupled step over MUMPS' multifrontal factors, in double and single precision.

#include <algorithm>
#include <utility>

#include "tests/bench/block_matrix.h"
#include "tests/bench/cholmod_factor.h"
#include "tests/bench/dense_cholesky.h"
#include "tests/bench/mumps_factor.h"
#include "tests/bench/phase_clock.h"
#include "tests/bench/route.h"

namespace lipofill::bench {
namespace {

using Eigen::VectorXd;

VectorXd right_side_of(const LinearStep& step) {
  VectorXd right(step.n_dofs() + step.n_cells());
  right << step.f, step.d;
  return right;
}

LinearAnswer answer_of(const LinearStep& step, const VectorXd& solution) {
  return {solution.head(step.n_dofs()), -solution.tail(step.n_cells())};
}

std::vector<int> choose_order(const BlockMatrix& matrix, const LinearStep& step, bool pressures_last) {
  if (pressures_last) return order_with_more_last(step.s, step.n_cells());
  return CholmodFactor(matrix.lower(), CholmodFactor::Kind::kSupernodal).order();
}

/// One L D L^T of [S B^T; B -J].
class QuasiDefiniteMumps : public Route {
 public:
  QuasiDefiniteMumps(const LinearStep& step, bool pressures_last)
      : matrix_(step, lower_of_films(step, -1.0)),
        factor_(matrix_.lower(), choose_order(matrix_, step, pressures_last)) {}

  absl::StatusOr<RouteRun> run(const LinearStep& step) override {
    RouteRun result;
    PhaseClock clock;
    matrix_.fill(step, lower_of_films(step, -1.0));
    if (const absl::Status status = factor_.factorise(matrix_.lower()); !status.ok()) return status;
    clock.done("factor");
    result.answer = answer_of(step, factor_.solve(right_side_of(step)));
    clock.done("solve");
    result.phases = clock.take();
    return result;
  }

 private:
  BlockMatrix matrix_;
  MumpsFactor<double> factor_;
};

/// The tissue eliminated, the pressures in the Schur complement -(J + C), which is solved densely.
class SchurMumps : public Route {
 public:
  explicit SchurMumps(const LinearStep& step)
      : matrix_(step, lower_of_films(step, -1.0)),
        factor_(matrix_.lower(), order_with_more_last(step.s, step.n_cells()), step.n_cells()) {}

  absl::StatusOr<RouteRun> run(const LinearStep& step) override {
    RouteRun result;
    PhaseClock clock;
    matrix_.fill(step, lower_of_films(step, -1.0));
    if (const absl::Status status = factor_.factorise(matrix_.lower()); !status.ok()) return status;
    clock.done("factor");
    const VectorXd reduced = factor_.condense(right_side_of(step));
    clock.done("solve");
    const VectorXd pressures = DenseCholesky(-factor_.schur_complement()).solve(-reduced);
    clock.done("pressure");
    result.answer = answer_of(step, factor_.expand(pressures));
    clock.done("displacement");
    result.phases = clock.take();
    return result;
  }

 private:
  BlockMatrix matrix_;
  MumpsFactor<double> factor_;
};

/// The same L D L^T in single precision, corrected by residuals in double precision.
class SinglePrecisionMumps : public Route {
 public:
  explicit SinglePrecisionMumps(const LinearStep& step)
      : matrix_(step, lower_of_films(step, -1.0)), factor_(matrix_.lower(), choose_order(matrix_, step, true)) {}

  absl::StatusOr<RouteRun> run(const LinearStep& step) override {
    RouteRun result;
    PhaseClock clock;
    matrix_.fill(step, lower_of_films(step, -1.0));
    if (const absl::Status status = factor_.factorise(matrix_.lower()); !status.ok()) return status;
    clock.done("factor");
    const VectorXd right = right_side_of(step);
    VectorXd x = factor_.solve(right);
    clock.done("solve");
    for (double change = 1.0; change > kTolerance && result.iterations < kMaxCorrections; ++result.iterations) {
      const VectorXd correction = factor_.solve(right - matrix_.lower().selfadjointView<Eigen::Lower>() * x);
      x += correction;
      change = relative_size(step, correction, x);
    }
    clock.done("corrections");
    result.answer = answer_of(step, x);
    result.phases = clock.take();
    return result;
  }

 private:
  static constexpr double kTolerance = 1e-10;
  static constexpr int kMaxCorrections = 30;

  static double relative_size(const LinearStep& step, const VectorXd& change, const VectorXd& x) {
    return std::max(change.head(step.n_dofs()).norm() / x.head(step.n_dofs()).norm(),
                    change.tail(step.n_cells()).norm() / x.tail(step.n_cells()).norm());
  }

  BlockMatrix matrix_;
  MumpsFactor<float> factor_;
};

template <typename R, typename... Arguments>
auto maker(Arguments... arguments) {
  return [arguments...](const LinearStep& step) -> absl::StatusOr<std::unique_ptr<Route>> {
    return std::make_unique<R>(step, arguments...);
  };
}

}  // namespace

std::vector<RouteKind> mumps_routes() {
  return {
      {"mumps", "MUMPS L D L^T of [S B^T; B -J], pressures last", maker<QuasiDefiniteMumps>(true)},
      {"mumps_interleaved", "the same, pressures ordered among the rest", maker<QuasiDefiniteMumps>(false)},
      {"mumps_schur", "the same, pressures in the Schur complement, which is solved densely", maker<SchurMumps>()},
      {"mumps_single", "the first in single precision, corrected in double precision to 1e-10",
       maker<SinglePrecisionMumps>()},
  };
}

}  // namespace lipofill::bench
