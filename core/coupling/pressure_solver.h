#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "core/film/film_projection.h"

namespace lipofill::coupling {

/// How the walls of all films give way to pressure, in volume/pressure space: gap' = rest + C p. Either full (the
/// tissue, EXACT) or diagonal (LUMPED; a Winkler wall, a/k a cell; a rigid wall, 0).
struct WallCompliance {
  const Eigen::MatrixXd* full = nullptr;  ///< C (n, n) or null
  Eigen::VectorXd diagonal;               ///< (n), used when `full` is null

  Eigen::VectorXd times(const Eigen::VectorXd& p) const;
};

/// Solves (dt J + C) dp = r in the cells of all films, some of which may hold their pressure.
///
/// Components of a film whose walls are rigid have a pressure that is known up to a constant only: it stays as it is in
/// the component's first cell, and what is injected there must balance. Checked by
/// tests/unit/coupling/film_solve_test.cc.
class PressureSolver {
 public:
  PressureSolver(const std::vector<film::FilmProjection*>& films, const WallCompliance& walls, int n);

  /// Takes dt J of every film at the pressures `p`.
  /// @param held  cells whose dp is 0 (n)
  /// Returns false when the matrix cannot be factored.
  bool solve(const Eigen::VectorXd& p, const std::vector<char>& held, const Eigen::VectorXd& r, Eigen::VectorXd& dp);

 private:
  bool solve_full(const Eigen::VectorXd& r, Eigen::VectorXd& dp);
  bool solve_sparse(const Eigen::VectorXd& r, Eigen::VectorXd& dp);
  void find_rigid_components();
  template <typename Visit>
  void for_each_entry(Visit visit) const;

  const std::vector<film::FilmProjection*>& films_;
  const WallCompliance& walls_;
  int n_;
  std::vector<int> gauge_cells_;
  std::vector<const Eigen::SparseMatrix<double>*> matrices_;  ///< dt J of each film
  const std::vector<char>* held_ = nullptr;
  Eigen::MatrixXd system_;
  Eigen::LLT<Eigen::MatrixXd> dense_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> sparse_;
  bool analysed_ = false;
};

}  // namespace lipofill::coupling
