#include "core/coupling/lagged_pressure_route.h"

#include "core/coupling/algebra_threads.h"
#include "core/coupling/blas.h"
#include "core/coupling/panel_solve.h"

namespace lipofill::coupling {
namespace {

/// A lagged solve that takes longer than the direct one does is given up.
int max_iterations(int n_cells) {
  return 10 + n_cells / 40;
}

}  // namespace

void LaggedPressureRoute::renew_preconditioner(const PressureSystem& system,
                                               const std::vector<Eigen::VectorXd>& mobility) {
  pin_algebra_to_this_thread();
  const int n = system.n_cells();
  const Eigen::MatrixXd& compliance = direct_.compliance();
  compliance_.assign(compliance);
  scale_ = 1.0 / compliance.diagonal().maxCoeff();
  if (factor_.rows() != n) factor_.setZero(n, n + 1);
  for (int c = 0; c < n; ++c) {
    factor_.col(c).tail(n - c) = (scale_ * compliance.col(c).tail(n - c)).cast<float>();
  }
  mobility_.resize(system.n_films());
  int offset = 0;
  for (size_t f = 0; f < system.n_films(); ++f) {
    Eigen::SparseMatrix<double>& j0 = mobility_[f];
    j0 = system.pattern(f);
    j0.coeffs() = mobility[f];
    for (int column = 0; column < j0.outerSize(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(j0, column); it; ++it) {
        if (it.row() < column) continue;  // the factor uses its lower triangle
        factor_(offset + it.row(), offset + column) += static_cast<float>(scale_ * it.value());
      }
    }
    offset += static_cast<int>(j0.cols());
  }
  is_exact_ = blas::factor_lower(n, factor_.data(), n);
  if (!is_exact_) factor_.setIdentity();
  PanelSolve<float>::invert_diagonal(factor_.data(), n, n);
}

bool LaggedPressureRoute::solve(const PressureSystem& system, const Eigen::VectorXd& r, double tolerance,
                                Eigen::VectorXd& dp, Eigen::VectorXd& moved) {
  const auto precondition = [this](const Eigen::VectorXd& from, Eigen::VectorXd& to) { this->precondition(from, to); };
  const bool moves_along = is_exact_ && !system.holds_any();
  const auto move = [&](const ConjugateGradients::Iterate& at, Eigen::VectorXd& moved_direction) {
    if (moves_along) return this->move(at, moved_direction);
    multiply_walls(at.direction, moved_direction);
  };
  const int most = max_iterations(system.n_cells());
  if (gradients_.solve(system, r, tolerance, most, precondition, move, dp, moved)) return true;
  ++fallbacks_;
  if (!direct_.solve_pressure(system, r, dp)) return false;
  multiply_walls(dp, moved);
  return dp.allFinite();
}

void LaggedPressureRoute::precondition(const Eigen::VectorXd& r, Eigen::VectorXd& z) {
  const auto n = static_cast<int>(r.size());
  const double size = r.cwiseAbs().maxCoeff();
  if (size == 0.0) {
    z.setZero(n);
    return;
  }
  work_.resize(n + PanelSolve<float>::kPadding);
  work_.head(n) = (r / size).cast<float>();
  const PanelSolve<float> factor(factor_.data(), n, n);
  factor.forward(work_.data());
  work_.tail(PanelSolve<float>::kPadding).setZero();
  factor.backward(work_.data());
  z = (size * scale_) * work_.head(n).cast<double>();
}

/// Computes C d from C z = r - J0 z, without a pass over C, which would be what an iteration costs.
void LaggedPressureRoute::move(const ConjugateGradients::Iterate& at, Eigen::VectorXd& moved_direction) {
  moved_conditioned_ = at.residual;
  int offset = 0;
  for (const Eigen::SparseMatrix<double>& j0 : mobility_) {
    moved_conditioned_.segment(offset, j0.cols()).noalias() -= j0 * at.conditioned.segment(offset, j0.cols());
    offset += static_cast<int>(j0.cols());
  }
  if (at.share_of_last == 0.0) {
    moved_direction = moved_conditioned_;
  } else {
    moved_direction = moved_conditioned_ + at.share_of_last * moved_direction;
  }
}

}  // namespace lipofill::coupling
