#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "core/coupling/symmetric_matrix.h"
#include "core/coupling/wall_compliance.h"
#include "core/film/film_projection.h"

namespace lipofill::coupling {

/// Solves (dt J + C) dp = r in the cells of all films, some of which may hold their pressure. By what C is:
///
/// - diagonal: sparse LDL^T;
/// - dense, up to kMaxDirectCells: Cholesky of J + C;
/// - dense, more cells: conjugate gradients preconditioned by the Cholesky factor, in float32, of J0 + C with the J0 of
///   keep_mobility, which stays for as long as C does: z = (J0 + C)^-1 r also gives C z = r - J0 z, so that an
///   iteration passes over the factor only, and what it moves is exact to float32; where they do not converge, Cholesky
///   of J + C (counted);
/// - implicit: conjugate gradients preconditioned by the sparse LDL^T of J + diag(C 1).
///
/// Components of a film whose walls are rigid have a pressure that is known up to a constant only: it stays as it is in
/// the component's first cell, and what is injected there must balance. Checked by
/// tests/unit/coupling/film_solve_test.cc and pressure_solver_test.cc.
class PressureSolver {
 public:
  static constexpr int kMaxDirectCells = 128;

  explicit PressureSolver(std::vector<film::FilmProjection*> films);

  /// The walls of the solves to come; what it points to must outlive them.
  void set_walls(const WallCompliance& walls);
  /// C p.
  void multiply_walls(const Eigen::VectorXd& p, Eigen::VectorXd& product) const;

  /// Whether solves with these walls need keep_mobility first.
  bool is_lagged() const { return walls_.dense != nullptr && n_ > kMaxDirectCells; }
  /// Iterations, over all that a fresh preconditioner would need, that cost as much as a new one.
  int iterations_of_a_preconditioner() const { return 4 + n_ / 45; }
  /// Makes the preconditioner of a dense C from J0, the values of dt J of each film in the order of
  /// FilmProjection::linearise.
  void keep_mobility(const std::vector<Eigen::VectorXd>& mobility);

  /// Takes dt J of every film at the pressures `p`.
  /// @param held       cells whose dp is 0 (n)
  /// @param tolerance  of conjugate gradients: the largest residual that may be left [m3]
  /// @param moved      C dp [m3], of many cells to float32: multiply_walls is exact
  /// Returns false when the matrix cannot be factored.
  bool solve(const Eigen::VectorXd& p, const std::vector<char>& held, const Eigen::VectorXd& r, double tolerance,
             Eigen::VectorXd& dp, Eigen::VectorXd& moved);

  /// Since the start: solves by conjugate gradients, their iterations, and times that they did not converge.
  long iterative_solves() const { return iterative_solves_; }
  long iterations() const { return iterations_; }
  long fallbacks() const { return fallbacks_; }

 private:
  int max_iterations() const;
  bool solve_dense(const Eigen::VectorXd& r, Eigen::VectorXd& dp);
  bool factor_sparse();
  template <typename Precondition>
  bool solve_iteratively(const Eigen::VectorXd& r, double tolerance, Precondition precondition, Eigen::VectorXd& dp,
                         Eigen::VectorXd& moved);
  void move_walls(double share_of_last);
  void apply_lagged(const Eigen::VectorXd& r, Eigen::VectorXd& z);
  void set_mobility(const Eigen::VectorXd& p);
  void add_mobility(const Eigen::VectorXd& p, Eigen::VectorXd& product) const;
  void hold(Eigen::VectorXd& values) const;
  void find_rigid_components();
  template <typename Visit>
  void for_each_entry(Visit visit) const;

  std::vector<film::FilmProjection*> films_;
  WallCompliance walls_;
  int n_ = 0;
  std::vector<int> gauge_cells_;
  std::vector<const Eigen::SparseMatrix<double>*> matrices_;  ///< dt J of each film
  const std::vector<char>* held_ = nullptr;
  Eigen::MatrixXd system_;
  SymmetricMatrix compliance_;  ///< C of the lagged route
  Eigen::MatrixXf lagged_;      ///< Cholesky factor of the scaled J0 + C, as PanelSolve reads it
  std::vector<Eigen::SparseMatrix<double>> lagged_mobility_;  ///< J0 of each film
  double lagged_scale_ = 1.0;
  bool is_lagged_exact_ = false;  ///< the factor is of J0 + C
  bool holds_any_ = false;
  Eigen::VectorXf lagged_work_;
  Eigen::SparseMatrix<double> sparse_system_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> sparse_;
  bool is_analysed_ = false;
  Eigen::VectorXd right_, residual_, direction_, conditioned_, product_, moved_direction_;
  long iterative_solves_ = 0;
  long iterations_ = 0;
  long fallbacks_ = 0;
};

}  // namespace lipofill::coupling
