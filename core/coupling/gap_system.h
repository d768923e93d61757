#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "core/coupling/gap_volume.h"

namespace lipofill::coupling {

/// The gaps of several films on one tissue, their cells one film after the other. Evaluating
/// allocates nothing.
class GapSystem {
 public:
  explicit GapSystem(std::vector<GapVolume> films, int n_dofs);

  /// Brings volume() and derivative() to the positions `x` (3, n_nodes) [m].
  void evaluate(const Eigen::Matrix3Xd& x);
  /// Brings volume() alone there, to the same bits.
  void evaluate_volume(const Eigen::Matrix3Xd& x);

  const Eigen::VectorXd& volume() const { return volume_; }                      ///< g [m3] (n_cells of all films)
  const Eigen::SparseMatrix<double>& derivative() const { return derivative_; }  ///< B (n_cells of all films, n_dofs)
  const GapVolume& film(int index) const { return films_[index]; }

 private:
  void collect_volume();

  std::vector<GapVolume> films_;
  Eigen::VectorXd volume_;
  Eigen::SparseMatrix<double> derivative_;
};

}  // namespace lipofill::coupling
