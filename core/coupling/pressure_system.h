#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "core/film/film_projection.h"

namespace lipofill::coupling {

/// The part of a solve for pressures that comes from the films, one after the other:
///
///     dt J = diag(dt J_1, dt J_2, ...)      -dV'/dp of each film at the pressures of the solve [m3/Pa]
///
/// with the cells that hold their pressure, dp = 0, and the gauge cells: components of a film whose
/// walls are rigid have a pressure that is known up to a constant only, so that it stays as it is
/// in the component's first cell, and what is injected there must balance. Doubling a gauge cell's
/// diagonal does that.
class PressureSystem {
 public:
  explicit PressureSystem(std::vector<film::FilmProjection*> films);

  int n_cells() const { return n_; }
  /// The matrix of a film, for its pattern.
  const Eigen::SparseMatrix<double>& pattern(size_t film) const { return films_[film]->pattern(); }
  size_t n_films() const { return films_.size(); }

  /// Finds the gauge cells.
  /// @param compliance  the diagonal of C (n)
  void set_compliance(const Eigen::VectorXd& compliance);
  /// Takes dt J at the pressures `p`; `held` (n) must outlive the solve.
  void linearise(const Eigen::VectorXd& p, const std::vector<char>& held);

  bool is_held(int cell) const { return (*held_)[cell] != 0; }
  bool holds_any() const { return holds_any_; }
  const std::vector<int>& gauge_cells() const { return gauge_cells_; }

  /// Adds dt J p to the product.
  void add_mobility(const Eigen::VectorXd& p, Eigen::VectorXd& product) const;
  /// Sets the values to 0 in the cells that are held.
  void hold(Eigen::VectorXd& values) const;

  /// Calls visit(row, column, value) for dt J, both triangles.
  template <typename Visit>
  void for_each_entry(Visit visit) const {
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

 private:
  std::vector<film::FilmProjection*> films_;
  std::vector<const Eigen::SparseMatrix<double>*> matrices_;  ///< dt J of each film
  int n_ = 0;
  std::vector<int> gauge_cells_;
  const std::vector<char>* held_ = nullptr;
  bool holds_any_ = false;
};

}  // namespace lipofill::coupling
