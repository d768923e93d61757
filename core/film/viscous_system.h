#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/film/edge_operators.h"
#include "core/film/film_grid.h"
#include "core/film/film_metric.h"

namespace lipofill::film {

/// The symmetric positive definite system of implicit viscosity on edge velocities U [m2/s]
/// (viscosity.h),
///
///     A = M(w) + D^T (s h/a) D + M(1) K^T (s h/a_v) K M(1)
///
/// with D the net outflow of cells, K the circulation around inner vertices, M the kinetic metric
/// of edge_operators.h, w [m] a weight of each edge and s = nu dt [m2]. It is never written down: a
/// product goes over the cells and the inner vertices. Checked by
/// tests/unit/film/viscous_system_test.cc.
class ViscousSystem {
 public:
  explicit ViscousSystem(const FilmGrid& grid);

  /// Brings M(1) to a metric; next is set.
  void set_metric(const FilmGrid& grid, const FilmMetric& metric) { compute_unit_mass_forms(grid, metric, unit_mass_); }
  /// The forms of M(1).
  const QuadrantForms& unit_mass() const { return unit_mass_; }
  /// Sets the system of the metric that set_metric was given last.
  /// @param edge_weight     w [m] (n_edges), each > 0
  /// @param cell_thickness  h [m] (n_cells); around a vertex its mean by area counts
  /// @param diffusion       s = nu dt [m2]
  void set(const FilmGrid& grid, const FilmMetric& metric, const Eigen::VectorXd& edge_weight,
           const Eigen::VectorXd& cell_thickness, double diffusion);

  /// A U. Allocates nothing after the first time.
  void multiply(const FilmGrid& grid, const Eigen::VectorXd& u, Eigen::VectorXd& product);
  /// The diagonal of A but for the products of different edges in M(1), for a preconditioner.
  const Eigen::VectorXd& diagonal() const { return diagonal_; }

 private:
  /// A vertex whose four edges are open.
  struct InnerVertex {
    std::array<int, 4> cells;    ///< by (side of xi) + 2 (side of eta)
    int low, right, high, left;  ///< edges, in the sense of circulation
    double thickness_over_area;  ///< s h/a_v, h the mean of the cells around
  };
  void set_vertices(const FilmMetric& metric, const Eigen::VectorXd& cell_thickness, double diffusion);
  void set_diagonal(const FilmGrid& grid);

  std::vector<InnerVertex> vertices_;
  QuadrantForms unit_mass_;
  QuadrantForms weighted_mass_;
  Eigen::VectorXd over_area_;                  ///< s h/a (n_cells)
  Eigen::VectorXd diagonal_;                   ///< (n_edges)
  Eigen::VectorXd root_;                       ///< scratch of scale_forms
  Eigen::VectorXd outflow_, momentum_, curl_;  ///< of a product
};

}  // namespace lipofill::film
