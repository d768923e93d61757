#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/equilibrium/pools.h"
#include "core/equilibrium/shape.h"
#include "core/mechanics/film_geometry.h"
#include "core/mechanics/tissue_system.h"

namespace lipofill::equilibrium {

/// The load is what acts on tissue and fat besides their own stiffness.
struct StaticLoad {
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< [m/s2]
  double fat_density = 0.0;                           ///< [kg/m3]
};

/// The forces and the gaps of a shape:
///
///     r = M g - f_int(x) + B(x)^T p,   p_i = H_z + rho g . c_i(x) + contact_i      [N]
///     gap_i = rest_i + g_i(x)                                                      [m3]
///
/// with H_z the head of the cell's pool and c_i the middle of the cell: what fat at rest has.
/// Checked by tests/unit/equilibrium/held_response_test.cc.
class StaticBalance {
 public:
  /// What is passed here outlives the balance.
  StaticBalance(mechanics::TissueSystem& system, const std::vector<plan::FilmLayout>& films,
                const mechanics::FilmCells& cells, const Pools& pools, mechanics::FilmGeometry& geometry,
                const StaticLoad& load);

  /// Brings everything to a shape with the springs that are intact (1, else 0).
  void bring_to(const Shape& shape, const Eigen::VectorXd& springs);
  /// Brings positions and gaps there, at a fraction of the cost; pressures and forces stay as they
  /// are.
  void bring_gaps_to(const Shape& shape);
  /// Brings pressures and forces of a shape to where its gaps are.
  void bring_forces_to_gaps(const Shape& shape, const Eigen::VectorXd& springs);

  const Eigen::Matrix3Xd& positions() const { return positions_; }         ///< x [m] (3, n_nodes)
  const Eigen::VectorXd& force() const { return force_; }                  ///< r (n_dofs)
  const Eigen::VectorXd& gap() const { return gap_; }                      ///< a cell on tissue (n_cells)
  const Eigen::VectorXd& cell_pressure() const { return cell_pressure_; }  ///< p [Pa] (n_cells)
  const Eigen::SparseMatrix<double>& derivative() const { return system_.gaps().derivative(); }  ///< B
  const Eigen::VectorXd& rest_volume() const { return rest_; }                                   ///< [m3] (n_cells)
  /// |r| over the forces that balance one another.
  double relative_force() const { return force_.norm() / scale_; }
  /// True when a hexahedron is turned inside out, or positions are not finite.
  bool is_folded() const;
  /// Head of fat in each cell above that of its pool, rho g . c [Pa] (n_cells); empty: no gravity.
  const Eigen::VectorXd& hydrostatic() const { return hydrostatic_; }

 private:
  void find_hydrostatic_pressure();

  mechanics::TissueSystem& system_;
  const std::vector<plan::FilmLayout>& films_;
  const mechanics::FilmCells& cells_;
  const Pools& pools_;
  mechanics::FilmGeometry& geometry_;
  StaticLoad load_;
  Eigen::VectorXd rest_;
  Eigen::VectorXd weight_;  ///< M g (n_dofs)
  Eigen::Matrix3Xd positions_;
  Eigen::VectorXd hydrostatic_, cell_pressure_, of_films_, force_, gap_;
  double scale_ = 1.0;
};

}  // namespace lipofill::equilibrium
