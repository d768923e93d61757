// Eigen's own sparse L D L^T.

#include <Eigen/SparseCholesky>
#include <utility>

#include "tests/bench/block_matrix.h"
#include "tests/bench/phase_clock.h"
#include "tests/bench/route.h"

namespace lipofill::bench {
namespace {

using Eigen::VectorXd;

class SimplicialEigen : public Route {
 public:
  explicit SimplicialEigen(const LinearStep& step) : matrix_(step, lower_of_films(step, -1.0)) {
    factor_.analyzePattern(matrix_.lower());
  }

  absl::StatusOr<RouteRun> run(const LinearStep& step) override {
    RouteRun result;
    PhaseClock clock;
    matrix_.fill(step, lower_of_films(step, -1.0));
    factor_.factorize(matrix_.lower());
    if (factor_.info() != Eigen::Success) return absl::InternalError("Eigen cannot factor the matrix");
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
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace

std::vector<RouteKind> eigen_routes() {
  const auto make = [](const LinearStep& step) -> absl::StatusOr<std::unique_ptr<Route>> {
    return std::make_unique<SimplicialEigen>(step);
  };
  return {{"eigen_simplicial", "Eigen, simplicial L D L^T of [S B^T; B -J], minimum degree", make, 1}};
}

}  // namespace lipofill::bench
