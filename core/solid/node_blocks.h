#pragma once

#include <Eigen/Core>

#include "core/solid/system_pattern.h"

namespace lipofill::solid {

/// Values of the lower triangle by blocks of two nodes, four numbers a column: three of K, and
/// behind the first column what K_G has on the block's diagonal (number times I). So a hexahedron
/// adds its matrix in whole registers, 108 of them instead of 324 numbers.
class NodeBlocks {
 public:
  explicit NodeBlocks(const SystemPattern& pattern) : values_(12, pattern.n_blocks() + 1) {}

  void set_zero() { values_.setZero(); }
  /// Twelve numbers a block of the pattern, and as many at the end for what is held.
  double* data() { return values_.data(); }

  /// Writes K to `stiffness` and factor K + K_G to `system`, values in the order of the pattern.
  /// @param constant_geometric  a number a block that belongs to K_G too; empty: none
  void write(const SystemPattern& pattern, const Eigen::VectorXd& constant_geometric, double factor, double* stiffness,
             double* system) const;

 private:
  Eigen::Matrix<double, 12, Eigen::Dynamic> values_;
};

/// Values of K and of S = factor K + K_G, to which single contributions are added where they
/// belong.
struct TangentValues {
  double* stiffness;
  double* system;
  double factor;

  void add_stiffness(int place, double value) {
    stiffness[place] += value;
    system[place] += factor * value;
  }
  void add_geometric(int place, double value) { system[place] += value; }
};

}  // namespace lipofill::solid
