#include "core/coupling/pressure_solver.h"

#include <algorithm>
#include <utility>

#include "core/coupling/algebra_threads.h"
#include "core/coupling/blas.h"
#include "core/coupling/panel_solve.h"

namespace lipofill::coupling {
namespace {

constexpr int kMaxImplicitIterations = 200;

}  // namespace

PressureSolver::PressureSolver(std::vector<film::FilmProjection*> films)
    : films_(std::move(films)), matrices_(films_.size()) {
  for (const film::FilmProjection* film : films_) n_ += film->grid().n_cells();
}

void PressureSolver::set_walls(const WallCompliance& walls) {
  const bool is_first = walls_.diagonal.size() == 0 && walls_.dense == nullptr;
  walls_ = walls;
  if (is_first) find_rigid_components();
}

void PressureSolver::multiply_walls(const Eigen::VectorXd& p, Eigen::VectorXd& product) const {
  if (is_lagged()) {
    compliance_.multiply(p, product);
  } else {
    walls_.multiply(p, product);
  }
}

/// A lagged solve that takes longer than the direct one does is given up.
int PressureSolver::max_iterations() const {
  return walls_.tissue != nullptr ? kMaxImplicitIterations : 10 + n_ / 40;
}

void PressureSolver::keep_mobility(const std::vector<Eigen::VectorXd>& mobility) {
  keep_algebra_on_this_thread();
  compliance_.assign(*walls_.dense);
  lagged_scale_ = 1.0 / walls_.dense->diagonal().maxCoeff();
  if (lagged_.rows() != n_) lagged_.setZero(n_, n_ + 1);
  for (int c = 0; c < n_; ++c) {
    lagged_.col(c).tail(n_ - c) = (lagged_scale_ * walls_.dense->col(c).tail(n_ - c)).cast<float>();
  }
  lagged_mobility_.resize(films_.size());
  int offset = 0;
  for (size_t f = 0; f < films_.size(); ++f) {
    Eigen::SparseMatrix<double>& j0 = lagged_mobility_[f];
    j0 = films_[f]->pattern();
    j0.coeffs() = mobility[f];
    for (int column = 0; column < j0.outerSize(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(j0, column); it; ++it) {
        if (it.row() < column) continue;  // of the factor the lower triangle is used
        lagged_(offset + it.row(), offset + column) += static_cast<float>(lagged_scale_ * it.value());
      }
    }
    offset += static_cast<int>(j0.cols());
  }
  is_lagged_exact_ = blas::factor_lower(n_, lagged_.data(), n_);
  if (!is_lagged_exact_) lagged_.setIdentity();
  PanelSolve<float>::invert_diagonal(lagged_.data(), n_, n_);
}

void PressureSolver::set_mobility(const Eigen::VectorXd& p) {
  int offset = 0;
  for (size_t f = 0; f < films_.size(); ++f) {
    const int n = films_[f]->grid().n_cells();
    matrices_[f] = &films_[f]->linearise(p.segment(offset, n));
    offset += n;
  }
}

bool PressureSolver::solve(const Eigen::VectorXd& p, const std::vector<char>& held, const Eigen::VectorXd& r,
                           double tolerance, Eigen::VectorXd& dp, Eigen::VectorXd& moved) {
  set_mobility(p);
  held_ = &held;
  holds_any_ = std::any_of(held.begin(), held.end(), [](char is_held) { return is_held != 0; });
  right_ = r;
  hold(right_);
  if (is_lagged()) {
    const auto precondition = [this](const Eigen::VectorXd& from, Eigen::VectorXd& to) { apply_lagged(from, to); };
    if (solve_iteratively(right_, tolerance, precondition, dp, moved)) return true;
    ++fallbacks_;
  }
  if (walls_.tissue != nullptr) {
    const auto precondition = [this](const Eigen::VectorXd& from, Eigen::VectorXd& to) { to = sparse_.solve(from); };
    return factor_sparse() && solve_iteratively(right_, tolerance, precondition, dp, moved);
  }
  const bool is_solved = walls_.dense != nullptr ? solve_dense(right_, dp) : factor_sparse();
  if (!is_solved) return false;
  if (walls_.dense == nullptr) dp = sparse_.solve(right_);
  multiply_walls(dp, moved);
  return dp.allFinite();
}

bool PressureSolver::solve_dense(const Eigen::VectorXd& r, Eigen::VectorXd& dp) {
  keep_algebra_on_this_thread();
  system_ = *walls_.dense;
  for_each_entry([&](int row, int column, double value) { system_(row, column) += value; });
  for (const int i : gauge_cells_) system_(i, i) *= 2.0;
  for (int i = 0; i < n_; ++i) {
    if (!(*held_)[i]) continue;
    const double diagonal = system_(i, i);
    system_.row(i).setZero();
    system_.col(i).setZero();
    system_(i, i) = diagonal;
  }
  if (!blas::factor_lower(n_, system_.data(), n_)) return false;
  dp = r;
  blas::solve_lower(n_, system_.data(), n_, dp.data(), false);
  blas::solve_lower(n_, system_.data(), n_, dp.data(), true);
  return true;
}

/// LDL^T of J + the diagonal.
bool PressureSolver::factor_sparse() {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(10 * static_cast<size_t>(n_));
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(n_);
  for_each_entry([&](int row, int column, double value) {
    const bool coupled = row == column || !((*held_)[row] || (*held_)[column]);
    triplets.emplace_back(row, column, coupled ? value : 0.0);
    if (row == column) diagonal[row] = value;
  });
  for (int i = 0; i < n_; ++i) triplets.emplace_back(i, i, walls_.diagonal[i]);
  for (const int i : gauge_cells_) triplets.emplace_back(i, i, diagonal[i]);
  sparse_system_.resize(n_, n_);
  sparse_system_.setFromTriplets(triplets.begin(), triplets.end());
  if (!is_analysed_) sparse_.analyzePattern(sparse_system_);
  is_analysed_ = true;
  sparse_.factorize(sparse_system_);
  return sparse_.info() == Eigen::Success;
}

/// Conjugate gradients from dp = 0, in the cells that are not held. False: no descent, or too many iterations.
template <typename Precondition>
bool PressureSolver::solve_iteratively(const Eigen::VectorXd& r, double tolerance, Precondition precondition,
                                       Eigen::VectorXd& dp, Eigen::VectorXd& moved) {
  const int most = max_iterations();
  ++iterative_solves_;
  dp.setZero(n_);
  moved.setZero(n_);
  residual_ = r;
  double last_descent = 0.0;
  for (int k = 0; k <= most; ++k) {
    if (residual_.cwiseAbs().maxCoeff() <= tolerance) return true;
    if (k == most) break;
    precondition(residual_, conditioned_);
    hold(conditioned_);
    const double descent = residual_.dot(conditioned_);
    if (!(descent > 0.0)) return false;
    if (k == 0) {
      direction_ = conditioned_;
    } else {
      direction_ = conditioned_ + (descent / last_descent) * direction_;
    }
    move_walls(k == 0 ? 0.0 : descent / last_descent);
    product_ = moved_direction_;
    add_mobility(direction_, product_);
    hold(product_);
    const double curvature = direction_.dot(product_);
    if (!(curvature > 0.0)) return false;
    const double share = descent / curvature;
    dp += share * direction_;
    moved += share * moved_direction_;
    residual_ -= share * product_;
    last_descent = descent;
    ++iterations_;
  }
  return false;
}

/// C times the direction. Where the preconditioner M = J0 + C is at hand and no cell is held, C z = r - J0 z for the z
/// that solves M z = r: no pass over C, which is what an iteration costs.
void PressureSolver::move_walls(double share_of_last) {
  if (!is_lagged() || !is_lagged_exact_ || holds_any_) return multiply_walls(direction_, moved_direction_);
  product_ = residual_;
  int offset = 0;
  for (const Eigen::SparseMatrix<double>& j0 : lagged_mobility_) {
    product_.segment(offset, j0.cols()).noalias() -= j0 * conditioned_.segment(offset, j0.cols());
    offset += static_cast<int>(j0.cols());
  }
  if (share_of_last == 0.0) {
    moved_direction_ = product_;
  } else {
    moved_direction_ = product_ + share_of_last * moved_direction_;
  }
}

void PressureSolver::apply_lagged(const Eigen::VectorXd& r, Eigen::VectorXd& z) {
  const double size = r.cwiseAbs().maxCoeff();
  if (size == 0.0) {
    z.setZero(n_);
    return;
  }
  lagged_work_.resize(n_ + PanelSolve<float>::kPadding);
  lagged_work_.head(n_) = (r / size).cast<float>();
  const PanelSolve<float> factor(lagged_.data(), n_, n_);
  factor.forward(lagged_work_.data());
  lagged_work_.tail(PanelSolve<float>::kPadding).setZero();
  factor.backward(lagged_work_.data());
  z = (size * lagged_scale_) * lagged_work_.head(n_).cast<double>();
}

void PressureSolver::add_mobility(const Eigen::VectorXd& p, Eigen::VectorXd& product) const {
  int offset = 0;
  for (const Eigen::SparseMatrix<double>* j : matrices_) {
    product.segment(offset, j->cols()).noalias() += *j * p.segment(offset, j->cols());
    offset += static_cast<int>(j->cols());
  }
}

void PressureSolver::hold(Eigen::VectorXd& values) const {
  for (int i = 0; i < n_; ++i) {
    if ((*held_)[i]) values[i] = 0.0;
  }
}

template <typename Visit>
void PressureSolver::for_each_entry(Visit visit) const {
  int offset = 0;
  for (const Eigen::SparseMatrix<double>* j : matrices_) {
    for (int column = 0; column < j->outerSize(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(*j, column); it; ++it) {
        visit(offset + static_cast<int>(it.row()), offset + column, it.value());
      }
    }
    offset += static_cast<int>(j->cols());
  }
}

/// First cell of every connected component without any compliance. Leaky walls connect.
void PressureSolver::find_rigid_components() {
  const Eigen::VectorXd compliance =
      walls_.dense != nullptr ? Eigen::VectorXd(walls_.dense->diagonal()) : walls_.diagonal;
  int offset = 0;
  for (const film::FilmProjection* film : films_) {
    const film::FilmGrid& grid = film->grid();
    std::vector<std::vector<int>> neighbours(grid.n_cells());
    const auto connect = [&](int a, int b) {
      neighbours[a].push_back(b);
      neighbours[b].push_back(a);
    };
    for (const film::Edge& edge : grid.edges) connect(edge.left, edge.right);
    for (const film::LeakyWall& wall : grid.leaky_walls) connect(wall.left, wall.right);
    std::vector<bool> seen(grid.n_cells(), false);
    for (int first = 0; first < grid.n_cells(); ++first) {
      if (seen[first]) continue;
      bool rigid = true;
      std::vector<int> stack = {first};
      seen[first] = true;
      while (!stack.empty()) {
        const int cell = stack.back();
        stack.pop_back();
        rigid = rigid && compliance[offset + cell] == 0.0;
        for (const int next : neighbours[cell]) {
          if (seen[next]) continue;
          seen[next] = true;
          stack.push_back(next);
        }
      }
      if (rigid) gauge_cells_.push_back(offset + first);
    }
    offset += grid.n_cells();
  }
}

}  // namespace lipofill::coupling
