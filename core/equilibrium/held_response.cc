#include "core/equilibrium/held_response.h"

#include <Eigen/LU>

namespace lipofill::equilibrium {
namespace {

/// More rows than these are those of cells.
constexpr Eigen::Index kFewRows = 24;
/// Rows whose pivots differ by more than this depend on one another.
constexpr double kLeastPivotShare = 1e-12;

}  // namespace

Eigen::MatrixXd find_rows(const Eigen::SparseMatrix<double>& derivative, const Pools& pools, const Shape& shape) {
  constexpr int kOpen = -1;
  std::vector<int> row_of_closed(static_cast<size_t>(pools.n_cells()), kOpen);
  for (size_t k = 0; k < shape.closed.size(); ++k) {
    row_of_closed[static_cast<size_t>(shape.closed[k])] = pools.n() + static_cast<int>(k);
  }
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(derivative.cols(), shape.n_rows());
  for (int dof = 0; dof < derivative.cols(); ++dof) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(derivative, dof); it; ++it) {
      const auto cell = static_cast<size_t>(it.row());
      rows(dof, pools.of_cell[cell]) += it.value();
      if (row_of_closed[cell] != kOpen) rows(dof, row_of_closed[cell]) += it.value();
    }
  }
  return rows;
}

Eigen::MatrixXd multiply_rows(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& columns) {
  if (rows.cols() <= kFewRows) return rows.transpose() * columns;
  const Eigen::SparseMatrix<double> few = rows.sparseView();
  return few.transpose() * columns;
}

bool HeldResponse::renew(const StaticBalance& balance, const Eigen::VectorXd& springs) {
  forget();
  of_closed_.clear();
  if (!factor_.factor_at(balance.positions(), springs)) return false;
  derivative_ = balance.derivative();
  const Shape no_cell_closed = Shape::at_rest(static_cast<int>(derivative_.cols()), pools_);
  factor_.solve_many(find_rows(derivative_, pools_, no_cell_closed), of_pools_);
  factored_at_ = balance.positions();
  return true;
}

bool HeldResponse::correct(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& missing,
                           Eigen::VectorXd& dx, Eigen::VectorXd& dp) {
  gather_columns(shape);
  factor_.solve(balance.force(), dx);
  return add_pressures(shape, find_rows(balance.derivative(), pools_, shape), missing, dx, dp);
}

bool HeldResponse::correct_volumes(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& missing,
                                   Eigen::VectorXd& dx, Eigen::VectorXd& dp) {
  gather_columns(shape);
  dx.setZero(of_pools_.rows());
  return add_pressures(shape, find_rows(balance.derivative(), pools_, shape), missing, dx, dp);
}

void HeldResponse::answer(const std::vector<Question*>& questions) {
  if (questions.empty()) return;
  Eigen::MatrixXd forces(of_pools_.rows(), static_cast<Eigen::Index>(questions.size())), solved;
  for (size_t k = 0; k < questions.size(); ++k) forces.col(static_cast<Eigen::Index>(k)) = questions[k]->force;
  factor_.solve_many(forces, solved);
  for (size_t k = 0; k < questions.size(); ++k) {
    Question& question = *questions[k];
    gather_columns(*question.shape);
    question.dx = solved.col(static_cast<Eigen::Index>(k));
    question.is_answered = add_pressures(*question.shape, question.rows, question.missing, question.dx, question.dp);
  }
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

/// With dx = S0^-1 r already: solves A S0^-1 A0^T dp = missing - A dx, for pools at the limit
/// dp = missing, and adds S0^-1 A0^T dp to dx.
bool HeldResponse::add_pressures(const Shape& shape, const Eigen::MatrixXd& rows, const Eigen::VectorXd& missing,
                                 Eigen::VectorXd& dx, Eigen::VectorXd& dp) {
  Eigen::MatrixXd schur = multiply_rows(rows, columns_);
  Eigen::VectorXd right = missing - rows.transpose() * dx;
  for (int pool = 0; pool < pools_.n(); ++pool) {
    if (!shape.is_at_limit[static_cast<size_t>(pool)]) continue;
    const double size = schur(pool, pool);
    schur.row(pool) = size * Eigen::RowVectorXd::Unit(schur.cols(), pool);
    right[pool] = size * missing[pool];
  }
  Eigen::FullPivLU<Eigen::MatrixXd> solver;
  solver.setThreshold(kLeastPivotShare);
  solver.compute(schur);
  if (!solver.isInvertible()) return false;
  dp = solver.solve(right);
  if (!dp.allFinite()) return false;
  dx.noalias() += columns_ * dp;
  return dx.allFinite();
}

}  // namespace lipofill::equilibrium
