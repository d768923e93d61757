#include "core/equilibrium/held_response.h"

#include <Eigen/LU>

namespace lipofill::equilibrium {
namespace {

/// Rows whose pivots differ by more than this depend on one another.
constexpr double kLeastPivotShare = 1e-12;

}  // namespace

bool HeldResponse::renew(const StaticBalance& balance, const Eigen::VectorXd& springs) {
  forget();
  of_closed_.clear();
  if (!factor_.factor_at(balance.positions(), springs)) return false;
  derivative_ = balance.derivative();
  of_pools_.resize(derivative_.cols(), pools_.n());
  Eigen::VectorXd column;
  for (int pool = 0; pool < pools_.n(); ++pool) {
    Eigen::VectorXd in_pool(pools_.n_cells());
    for (int cell = 0; cell < pools_.n_cells(); ++cell) in_pool[cell] = pools_.of_cell[cell] == pool;
    factor_.solve(derivative_.transpose() * in_pool, column);
    of_pools_.col(pool) = column;
  }
  factored_at_ = balance.positions();
  return true;
}

bool HeldResponse::answer(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& force,
                          const Eigen::VectorXd& missing, Eigen::VectorXd& dx, Eigen::VectorXd& dp) {
  gather_columns(shape);
  factor_.solve(force, dx);
  const Eigen::VectorXd right = missing - shape.reduce(pools_, balance.derivative() * dx);
  if (!solve_rows(balance, shape, right, missing, dp)) return false;
  dx.noalias() += columns_ * dp;
  return dx.allFinite();
}

bool HeldResponse::correct_volumes(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& missing,
                                   Eigen::VectorXd& dx, Eigen::VectorXd& dp) {
  gather_columns(shape);
  if (!solve_rows(balance, shape, missing, missing, dp)) return false;
  dx.noalias() = columns_ * dp;
  return dx.allFinite();
}

void HeldResponse::gather_columns(const Shape& shape) {
  columns_.resize(of_pools_.rows(), shape.n_rows());
  columns_.leftCols(pools_.n()) = of_pools_;
  for (size_t k = 0; k < shape.closed.size(); ++k) {
    columns_.col(pools_.n() + static_cast<Eigen::Index>(k)) = column_of_cell(shape.closed[k]);
  }
}

const Eigen::VectorXd& HeldResponse::column_of_cell(int cell) {
  Eigen::VectorXd& column = of_closed_[cell];
  if (column.size() > 0) return column;
  const Eigen::VectorXd unit = Eigen::VectorXd::Unit(pools_.n_cells(), cell);
  factor_.solve(derivative_.transpose() * unit, column);
  return column;
}

/// dp with A S0^-1 A0^T dp = right; of pools at the limit dp = missing.
bool HeldResponse::solve_rows(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& right,
                              const Eigen::VectorXd& missing, Eigen::VectorXd& dp) {
  const Eigen::Index n = shape.n_rows();
  Eigen::MatrixXd schur(n, n);
  for (Eigen::Index k = 0; k < n; ++k) schur.col(k) = shape.reduce(pools_, balance.derivative() * columns_.col(k));
  Eigen::VectorXd given = right;
  for (int pool = 0; pool < pools_.n(); ++pool) {
    if (!shape.is_at_limit[static_cast<size_t>(pool)]) continue;
    const double size = schur(pool, pool);
    schur.row(pool) = size * Eigen::RowVectorXd::Unit(n, pool);
    given[pool] = size * missing[pool];
  }
  Eigen::FullPivLU<Eigen::MatrixXd> solver;
  solver.setThreshold(kLeastPivotShare);
  solver.compute(schur);
  if (!solver.isInvertible()) return false;
  dp = solver.solve(given);
  return dp.allFinite();
}

}  // namespace lipofill::equilibrium
