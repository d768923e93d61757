#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "core/coupling/gap_geometry.h"
#include "core/film/film_grid.h"
#include "core/geometry/layered_grid.h"

namespace lipofill::coupling {

/// Gap volume over every film cell as a function of the node positions, and its exact derivative:
///
///     g_i(x) = int over cell i, 0 < s < 1 of  det(dX_s/dxi, dX_s/deta, X_out - X_in),   X_s = X_in + s (X_out - X_in)
///     B      = dg/dx       (the paper's A H; B^T p is the force of the film's pressure on the tissue)
///
/// Walls are bilinear on the tissue's quadrilaterals; cells may lie anywhere on them: each is cut
/// along the quadrilaterals' borders and integrated piece by piece (gap_integral.h), which is
/// exact. Copies share the geometry. Evaluating allocates nothing. Checked by
/// tests/unit/coupling/gap_volume_test.cc (closed forms, finite differences, action equals
/// reaction).
class GapVolume {
 public:
  /// @param dof_of_component  degree of freedom of component c of node a at 3 a + c, -1 where fixed
  GapVolume(const geometry::LayeredGrid& tissue, const WallNodes& walls, const film::FilmGrid& film,
            const std::vector<int>& dof_of_component, int n_dofs);
  explicit GapVolume(std::shared_ptr<const GapGeometry> geometry);

  /// Brings volume() and derivative() to the positions `x` (3, n_nodes) [m].
  void evaluate(const Eigen::Matrix3Xd& x);
  /// Brings volume() there, to the same bits, and leaves derivative() where it is; a third of the
  /// cost.
  void evaluate_volume(const Eigen::Matrix3Xd& x);

  const Eigen::VectorXd& volume() const { return volume_; }                      ///< g [m3] (n_cells)
  const Eigen::SparseMatrix<double>& derivative() const { return derivative_; }  ///< B [m2] (n_cells, n_dofs)

  /// Positions of the film grid's vertices half-way between the walls [m] (3, n_vertices).
  void mid_surface(const Eigen::Matrix3Xd& x, Eigen::Matrix3Xd& vertices) const;
  Eigen::Matrix3Xd mid_surface(const Eigen::Matrix3Xd& x) const;

  const std::shared_ptr<const GapGeometry>& geometry() const { return geometry_; }

 private:
  template <bool kWithDerivative>
  void integrate(const Eigen::Matrix3Xd& x);
  void scatter_derivative();

  std::shared_ptr<const GapGeometry> geometry_;
  Eigen::VectorXd volume_;
  Eigen::SparseMatrix<double> derivative_;
  /// A wall place: derivative by its outer and its inner node, four numbers each, the last of no
  /// meaning.
  Eigen::Matrix<double, 8, Eigen::Dynamic> gradients_;
};

/// Volume between two positions of a surface of nodes, positive where `current` lies outside of
/// `rest` [m3].
double compute_swept_volume(const geometry::LayeredGrid& grid, const Eigen::Matrix3Xd& rest,
                            const Eigen::Matrix3Xd& current);

}  // namespace lipofill::coupling
