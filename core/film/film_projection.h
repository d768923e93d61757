#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "core/film/edge_operators.h"
#include "core/film/film_grid.h"
#include "core/film/film_metric.h"
#include "core/film/flow_law.h"
#include "core/film/rheology.h"

namespace lipofill::film {

/// The input of a film to a step: everything but the pressure.
struct FilmStepInput {
  const FilmMetric* metric = nullptr;
  Fat fat;
  Eigen::VectorXd volume;            ///< V at the start of the step [m3] (n_cells)
  Eigen::VectorXd injected;          ///< volume that sources bring in this step [m3] (n_cells)
  Eigen::VectorXd velocity;          ///< U after viscosity and advection [m2/s] (n_edges); 0 for fat without inertia
  Eigen::VectorXd body_force;        ///< rho b . (X_right - X_left) [Pa] (n_edges); it drives as a pressure fall does
  double dt = 0.0;                   ///< [s]
  Eigen::VectorXd wall_stress;       ///< T = h s / 2 of the last step [Pa m] (n_edges); empty: fat is not elastic
  std::vector<char> is_closed;       ///< cells that fat has not entered yet (n_cells); empty: none
  double leak_full_thickness = 0.0;  ///< a leaky wall's flux falls to zero below this upstream thickness [m]
};

/// The film's projection for a mobility given by a guess of the new thickness:
///
///     F  = h_e U + law(rho b . dX - G p)    flux [m3/s], law of flow_law.h
///     F  = k (p_l - p_r)                    through leaky walls
///     V' = V + injected + dt G^T F
///
/// in flux form: what leaves a cell enters its neighbour, to the last bit but rounding. After the
/// first step nothing is allocated. Checked by tests/unit/coupling/film_solve_test.cc.
class FilmProjection {
 public:
  explicit FilmProjection(const FilmGrid& grid);

  /// The input of the next step, to be filled in place before begin_step; until then it holds that
  /// of the last step.
  FilmStepInput& next_input() { return input_; }
  void begin_step();
  void begin_step(FilmStepInput input);

  /// Takes edge thicknesses and with them mobilities from a guess of the new volume, upwind by a
  /// guess of the flux.
  void set_thickness(const Values& volume_guess, const Values& flux_guess);

  /// True when V' is linear in p.
  bool is_linear() const { return law_.is_linear(); }
  /// -dV'/dp = dt J at a pressure [m3/Pa]; both triangles, in a pattern that never changes.
  const Eigen::SparseMatrix<double>& linearise(const Values& pressure);
  /// The matrix of the last linearise, for its pattern.
  const Eigen::SparseMatrix<double>& pattern() const { return pressure_operator_.matrix(); }
  /// F at a pressure, through the open edges and then the leaky walls [m3/s]
  /// (n_edges + n_leaky_walls).
  void compute_flux(const Values& pressure, Eigen::VectorXd& flux);
  Eigen::VectorXd compute_flux(const Values& pressure);
  /// V' of a flux [m3] (n_cells).
  void compute_volume(const Values& flux, Eigen::Ref<Eigen::VectorXd> volume) const;
  Eigen::VectorXd compute_volume(const Values& flux) const;
  /// U' of a flux [m2/s] (n_edges); 0 on dry edges.
  void compute_velocity(const Values& flux, Eigen::VectorXd& velocity) const;
  /// T' = h D / 2 at a pressure [Pa m] (n_edges); empty when the fat is not elastic.
  void compute_wall_stress(const Values& pressure, Eigen::VectorXd& stress) const;

  const FilmGrid& grid() const { return *grid_; }
  const FilmStepInput& input() const { return input_; }

 private:
  void compute_drive(const Values& pressure, Eigen::VectorXd& drive) const;
  void set_leaks(const Values& flux_guess);

  const FilmGrid* grid_;
  PressureOperator pressure_operator_;
  FlowLaw law_;
  FilmStepInput input_;
  Eigen::VectorXd thickness_;  ///< the guess has this thickness [m] (n_cells)
  Eigen::VectorXd edge_thickness_;
  Eigen::VectorXd drive_;  ///< D, of the last call that needed it [Pa] (n_edges)
  Eigen::VectorXd leak_conductance_;
  bool matrix_is_current_ = false;
  const Eigen::SparseMatrix<double>* matrix_ = nullptr;
};

}  // namespace lipofill::film
