#include "core/coupling/pressure_solver.h"

#include <algorithm>

namespace lipofill::coupling {

Eigen::VectorXd WallCompliance::times(const Eigen::VectorXd& p) const {
  if (full != nullptr) return *full * p;
  return diagonal.cwiseProduct(p);
}

PressureSolver::PressureSolver(const std::vector<film::FilmProjection*>& films, const WallCompliance& walls, int n)
    : films_(films), walls_(walls), n_(n), matrices_(films.size()) {
  find_rigid_components();
}

bool PressureSolver::solve(const Eigen::VectorXd& p, const std::vector<char>& held, const Eigen::VectorXd& r,
                           Eigen::VectorXd& dp) {
  int offset = 0;
  for (size_t f = 0; f < films_.size(); ++f) {
    const int n = films_[f]->grid().n_cells();
    matrices_[f] = &films_[f]->linearise(p.segment(offset, n));
    offset += n;
  }
  held_ = &held;
  Eigen::VectorXd right = r;
  for (int i = 0; i < n_; ++i) {
    if (held[i]) right[i] = 0.0;
  }
  const bool solved = walls_.full != nullptr ? solve_full(right, dp) : solve_sparse(right, dp);
  return solved && dp.allFinite();
}

bool PressureSolver::solve_full(const Eigen::VectorXd& r, Eigen::VectorXd& dp) {
  system_ = *walls_.full;
  for_each_entry([&](int row, int column, double value) { system_(row, column) += value; });
  for (const int i : gauge_cells_) system_(i, i) *= 2.0;
  for (int i = 0; i < n_; ++i) {
    if (!(*held_)[i]) continue;
    const double diagonal = system_(i, i);
    system_.row(i).setZero();
    system_.col(i).setZero();
    system_(i, i) = diagonal;
  }
  dense_.compute(system_);
  if (dense_.info() != Eigen::Success) return false;
  dp = dense_.solve(r);
  return true;
}

bool PressureSolver::solve_sparse(const Eigen::VectorXd& r, Eigen::VectorXd& dp) {
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
  Eigen::SparseMatrix<double> system(n_, n_);
  system.setFromTriplets(triplets.begin(), triplets.end());
  if (!analysed_) sparse_.analyzePattern(system);
  analysed_ = true;
  sparse_.factorize(system);
  if (sparse_.info() != Eigen::Success) return false;
  dp = sparse_.solve(r);
  return true;
}

template <typename Visit>
void PressureSolver::for_each_entry(Visit visit) const {
  int offset = 0;
  for (size_t f = 0; f < films_.size(); ++f) {
    const Eigen::SparseMatrix<double>& j = *matrices_[f];
    for (int column = 0; column < j.outerSize(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(j, column); it; ++it) {
        visit(offset + static_cast<int>(it.row()), offset + column, it.value());
      }
    }
    offset += films_[f]->grid().n_cells();
  }
}

/// First cell of every connected component without any compliance. Leaky walls connect.
void PressureSolver::find_rigid_components() {
  const Eigen::VectorXd compliance =
      walls_.full != nullptr ? Eigen::VectorXd(walls_.full->diagonal()) : walls_.diagonal;
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
