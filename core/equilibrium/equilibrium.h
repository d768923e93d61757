#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/equilibrium/load_change.h"
#include "core/equilibrium/parts.h"
#include "core/equilibrium/rest_start.h"
#include "core/equilibrium/solver.h"
#include "core/equilibrium/trend.h"

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

/// The change of a shape by a unit of each parameter, to first order, good to 1 %; nothing for a
/// parameter whose answer does not converge.
struct Sensitivities {
  std::vector<std::optional<Sensitivity>> by_volume;   ///< of each pool [1/m3]
  std::vector<std::optional<Sensitivity>> by_modulus;  ///< of ln E of each layer
  std::vector<std::optional<Sensitivity>> by_tissue;   ///< of the parameter of each TissueBeside
};

class Equilibrium;

/// A tissue that differs by a little of some parameter, with the same nodes, cells and injections.
struct TissueBeside {
  Equilibrium* tissue = nullptr;
  double step = 0.0;  ///< of the parameter
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
  /// @param entered  the cells that fat has entered, as find_pools takes them: it enters no more
  static absl::StatusOr<std::unique_ptr<Equilibrium>> create(
      const model::FaceModel& model, const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
      mechanics::TissueSystem& system, mechanics::FilmGeometry& geometry, const StaticLoad& load,
      mechanics::StepCost& cost, const std::vector<Eigen::VectorXd>& entered = {});

  const Pools& pools() const { return parts_.pools; }
  /// Each pool holds this at rest thickness [m3].
  Eigen::VectorXd rest_volume() const { return pools().sum(parts_.balance.rest_volume()); }

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

  /// Finds what a unit of each parameter does to the last shape; all of its volume is in. The
  /// parameters are answered side by side, by a factor of that shape: it pays from some four
  /// parameters on.
  Sensitivities differentiate(const std::vector<TissueBeside>& beside);
  /// Does the same for the pools' volumes alone, by the factor that is at hand.
  std::vector<std::optional<Sensitivity>> differentiate_by_volume();

  /// For those that go other ways with the same tissue (ensemble.h).
  Parts& parts() { return parts_; }
  const Found& last() const { return last_; }
  /// A shape in balance, where the balance is.
  Settled describe(const PoolTarget& target, const Shape& shape, double share) const;

 private:
  Equilibrium(const model::FaceModel& model, std::unique_ptr<mechanics::TissueFactor> factor,
              const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
              mechanics::TissueSystem& system, mechanics::FilmGeometry& geometry, const StaticLoad& load,
              const std::vector<Eigen::VectorXd>& entered)
      : parts_(std::move(factor), films, cells, system, geometry, load, entered), rest_start_(model, parts_, load) {}
  bool leave_last(const PoolTarget& target, Shape& shape);
  void remember(Shape shape, const PoolTarget& target, const Eigen::VectorXd& springs, bool is_from_rest);
  std::vector<std::optional<Sensitivity>> answer(const std::vector<LoadChange>& changes);

  Parts parts_;
  RestStart rest_start_;
  Found last_;
  bool is_from_rest_ = false;
  Trend trend_;                 ///< of the shapes that followed one another to the last one
  AndersonMixing drag_mixing_;  ///< of their iterations
};

}  // namespace lipofill::equilibrium
