#pragma once

#include <Eigen/Core>
#include <utility>

namespace lipofill::equilibrium {

/// The trend says where a drag goes next, learned from the shapes that it came by. J is what a unit
/// of each pool's volume does to the unknowns (Broyden 1965):
///
///     y + J dV,   J <- J + (dy - J dV) dV^T / (dV . dV)
///
/// and where the last two moves are along one line, as those of a slider are, the parabola through
/// the last three shapes in its place.
/// Checked by tests/unit/equilibrium/trend_test.cc.
class Trend {
 public:
  void forget();
  bool is_for(Eigen::Index n_unknowns) const { return per_volume_.rows() == n_unknowns; }
  /// @param per_volume  J to begin with (n_unknowns, n_pools)
  void begin(Eigen::MatrixXd per_volume);

  /// Tells how the unknowns change with the volumes [m3].
  Eigen::VectorXd predict(const Eigen::VectorXd& volume) const;
  /// Learns that a change of the volumes brought a change of the unknowns.
  void learn(const Eigen::VectorXd& volume, const Eigen::VectorXd& unknowns);

 private:
  struct Move {
    Eigen::VectorXd volume, unknowns;  ///< empty: there was none
  };

  Eigen::MatrixXd per_volume_;
  Move last_, before_;
};

}  // namespace lipofill::equilibrium
