#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/equilibrium/contact.h"
#include "core/equilibrium/pools.h"
#include "core/equilibrium/solver.h"
#include "core/equilibrium/static_balance.h"
#include "core/equilibrium/tangent.h"

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

/// The change of a shape by a unit of a parameter.
struct Sensitivity {
  Eigen::Matrix3Xd displacement;  ///< [m] (3, n_nodes)
  Eigen::VectorXd pool_head;      ///< [Pa]
};

/// The static problem of fat at rest, the limit t -> infinity of a plan in scope (scope.h):
///
///     f_int(x) - M g = B(x)^T p,   p_i = H_z + rho g . c_i,   sum over pool z of gap_i(x) = V_z,   gap_i >= 0
///
/// solved from rest by solver.h; where that fails, along a path of growing volume. Where the path
/// ends - a limit point, an element about to turn inside out - the answer is the last shape on it.
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

  /// The shape for a target, from rest: it depends on what is passed in alone.
  /// @param springs    of ligaments that are intact: 1, else 0
  /// @param tolerance  of the forces: 1e-3 leaves some 5e-4 mm of the skin
  Settled find(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance);

  /// The same from the last shape, with the factor that is at hand: for targets that change by
  /// little, at a fraction of the cost. It depends on the way there within the tolerance. Where
  /// that fails it is found from rest.
  /// @param springs  as they were for the last shape
  Settled follow(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance);
  /// True when the last shape was found from rest.
  bool is_from_rest() const { return is_from_rest_; }

  /// For ensembles (ensemble.h): factors at the last shape, and holds both.
  void hold_here();
  /// The shape for a target from the one held, with its factor; from rest where that fails.
  Settled find_from_held(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance);
  /// Makes the factor that is held again, where another took its place.
  void return_to_held();
  /// TissueSystem::scale_moduli.
  absl::Status scale_moduli(const Eigen::VectorXd& factors) { return system_.scale_moduli(factors); }

  /// What a unit of each parameter does to the last shape, to first order, good to 1 %; all of its
  /// volume is in. A parameter whose answer does not converge has none.
  std::vector<std::optional<Sensitivity>> differentiate_by_volume();   ///< of each pool [1/m3]
  std::vector<std::optional<Sensitivity>> differentiate_by_modulus();  ///< of ln E of each layer
  /// The same of whatever makes the tissue of `beside` from this one, with the same nodes, cells
  /// and injections, by `step` units of it.
  std::optional<Sensitivity> differentiate_towards(Equilibrium& beside, double step);

 private:
  Equilibrium(Pools pools, std::unique_ptr<mechanics::TissueFactor> factor, const std::vector<plan::FilmLayout>& films,
              const mechanics::FilmCells& cells, mechanics::TissueSystem& system, mechanics::FilmGeometry& geometry,
              const StaticLoad& load);
  Settled describe(const PoolTarget& target, const Shape& shape, double share) const;
  const Shape& refine_last();
  bool has_same_unknowns(const Equilibrium& other) const;
  std::optional<Eigen::VectorXd> differentiate_force(const Shape& at, int layer);
  std::optional<Sensitivity> differentiate(const Shape& at, const LoadChange& change);

  Pools pools_;
  mechanics::TissueSystem& system_;
  std::unique_ptr<mechanics::TissueFactor> factor_;
  StaticBalance balance_;
  HeldResponse response_;
  Shape last_;              ///< no row: there is none
  PoolTarget last_target_;  ///< that it was found for
  Eigen::VectorXd last_springs_;
  bool is_from_rest_ = false;
  Shape held_;
  PoolTarget held_target_;
  bool is_held_ = false;  ///< the factor is of held_ and of the nominal moduli
};

}  // namespace lipofill::equilibrium
