#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/film/edge_operators.h"
#include "core/film/film_grid.h"
#include "core/film/film_metric.h"
#include "core/film/rheology.h"

namespace lipofill::film {

/// What a film brings into a step: everything but the pressure.
struct FilmStepInput {
  const FilmMetric* metric = nullptr;
  Fat fat;
  Eigen::VectorXd volume;      ///< V at the start of the step [m3] (n_cells)
  Eigen::VectorXd injected;    ///< volume that sources bring in this step [m3] (n_cells)
  Eigen::VectorXd velocity;    ///< U after viscosity and advection [m2/s] (n_edges)
  Eigen::VectorXd body_force;  ///< rho b . (X_right - X_left) [Pa] (n_edges); it drives flow as a pressure fall does
  double dt = 0.0;             ///< [s]
};

/// The film's projection for a mobility given by a guess of the new thickness:
///
///     F  = h_e U - W (G p - rho b . dX)                    flux [m3/s]
///     V' = V + injected + dt G^T F
///
/// so that V' = explicit_volume - dt J p, in flux form: what leaves a cell enters its neighbour, to the last bit but
/// rounding. Checked by tests/unit/coupling/film_solve_test.cc.
class FilmProjection {
 public:
  explicit FilmProjection(const FilmGrid& grid);

  void begin_step(FilmStepInput input);

  /// Takes edge thicknesses and conductances from a guess of the new volume, upwind by a guess of the flux.
  void linearise(const Eigen::VectorXd& volume_guess, const Eigen::VectorXd& flux_guess);

  /// dt J of the last linearise  [m3/Pa].
  const Eigen::SparseMatrix<double>& pressure_matrix() const { return *pressure_matrix_; }
  /// V' at zero pressure [m3].
  const Eigen::VectorXd& explicit_volume() const { return explicit_volume_; }
  /// F at a pressure [m3/s].
  Eigen::VectorXd compute_flux(const Eigen::VectorXd& pressure) const;
  /// V' of a flux [m3].
  Eigen::VectorXd compute_volume(const Eigen::VectorXd& flux) const;
  /// U' of a flux [m2/s]; 0 on dry edges.
  Eigen::VectorXd compute_velocity(const Eigen::VectorXd& flux) const;

  const FilmGrid& grid() const { return *grid_; }
  const FilmStepInput& input() const { return input_; }

 private:
  const FilmGrid* grid_;
  PressureOperator pressure_operator_;
  FilmStepInput input_;
  Eigen::VectorXd edge_thickness_;
  Eigen::VectorXd conductance_;
  Eigen::VectorXd explicit_flux_;
  Eigen::VectorXd explicit_volume_;
  const Eigen::SparseMatrix<double>* pressure_matrix_ = nullptr;
};

}  // namespace lipofill::film
