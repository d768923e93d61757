#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/equilibrium/contact.h"
#include "core/equilibrium/pools.h"
#include "core/equilibrium/solver.h"
#include "core/equilibrium/static_balance.h"

namespace lipofill::equilibrium {

/// A settled shape, or as much of it as there is.
struct Settled {
  double share = 0.0;             ///< of the volumes beyond rest that are in; 1: all
  std::string reason;             ///< why no more is in; empty where all is
  Eigen::Matrix3Xd positions;     ///< [m] (3, n_nodes)
  Eigen::VectorXd cell_volume;    ///< gap, >= 0 [m3] (n_cells on tissue)
  Eigen::VectorXd cell_pressure;  ///< of the fat, in closed cells with that of contact [Pa] (n_cells on tissue)
  Eigen::VectorXd pool_volume;    ///< [m3]
  Eigen::VectorXd pool_head;      ///< [Pa]
  Eigen::VectorXd fat_volume;     ///< of each pool [m3]: less than pool_volume where it is at the suction limit
  std::vector<char> is_at_limit;  ///< 1: the pool is at the suction limit
  std::vector<int> closed;        ///< cells whose walls touch, ascending
  double force_error = 0.0;       ///< what is left of the forces, share of those that act
  bool is_double = false;         ///< float32 was not enough for the factor
  SolverCost cost;

  bool is_whole() const { return share == 1.0; }
};

/// The static problem of fat at rest, the limit t -> infinity of a plan in scope (scope.h):
///
///     f_int(x) - M g = B(x)^T p,   p_i = H_z + rho g . c_i,   sum over pool z of gap_i(x) = V_z,   gap_i >= 0
///
/// solved from rest by solver.h; where that fails, along a path of growing volume. Where the path
/// ends - a limit point, an element about to turn inside out - the answer is the last shape on it.
/// Deterministic: it depends on what is passed in alone, never on earlier calls.
/// Checked by tests/unit/equilibrium/ and tests/verification/equilibrium/.
class Equilibrium {
 public:
  /// What is passed here outlives the equilibrium. Errors as TissueFactor::create.
  static absl::StatusOr<std::unique_ptr<Equilibrium>> create(const model::FaceModel& model,
                                                             const std::vector<plan::FilmLayout>& films,
                                                             const mechanics::FilmCells& cells,
                                                             mechanics::TissueSystem& system,
                                                             mechanics::FilmGeometry& geometry, const StaticLoad& load,
                                                             mechanics::StepCost& cost);

  const Pools& pools() const { return pools_; }
  /// Of each pool at rest thickness [m3].
  Eigen::VectorXd rest_volume() const { return pools_.sum(balance_.rest_volume()); }

  /// @param springs    of ligaments that are intact: 1, else 0
  /// @param tolerance  of the forces: 1e-3 leaves some 5e-4 mm of the skin
  Settled find(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance);

  /// dx/dV [1/m2], for each pool the displacements (3, n_nodes) that a volume more of it brings,
  /// with the volumes of the others kept: differences along the solver's own iterations with the
  /// factor of the shape, good to 1 %. Empty where a shape beside the settled one is not found.
  /// @param settled  what find() gave for the target and the springs, all of it in
  std::vector<Eigen::Matrix3Xd> differentiate(const PoolTarget& target, const Settled& settled,
                                              const Eigen::VectorXd& springs);

 private:
  Equilibrium(Pools pools, std::unique_ptr<mechanics::TissueFactor> factor, const std::vector<plan::FilmLayout>& films,
              const mechanics::FilmCells& cells, mechanics::TissueSystem& system, mechanics::FilmGeometry& geometry,
              const StaticLoad& load);
  Settled describe(const PoolTarget& target, const Shape& shape, double share) const;
  Shape shape_of(const Settled& settled, const Eigen::VectorXd& springs);

  Pools pools_;
  std::unique_ptr<mechanics::TissueFactor> factor_;
  StaticBalance balance_;
  int n_dofs_;
};

}  // namespace lipofill::equilibrium
