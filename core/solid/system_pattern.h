#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <vector>

namespace lipofill::solid {

/// Numbering of the degrees of freedom and the lower triangle they couple in: node by node, fixed components left out,
/// every two nodes of a hexahedron coupled, and every two of a group. Depends on its arguments only.
class SystemPattern {
 public:
  SystemPattern(int n_nodes, const std::vector<std::array<int, 8>>& hexahedra,
                const std::vector<std::array<bool, 3>>& fixed, const std::vector<std::vector<int>>& groups = {});

  int n_dofs() const { return static_cast<int>(matrix_.cols()); }
  /// Degree of freedom of component c of node a at 3 a + c; -1 where fixed.
  const std::vector<int>& dof_of_component() const { return dof_of_component_; }
  /// The pattern, values zero; columns ascending, rows ascending in each.
  const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }
  /// Where the value of (max(i, j), min(i, j)) is; the nodes of the two must share a hexahedron or a group.
  int find(int i, int j) const;

 private:
  std::vector<int> dof_of_component_;
  Eigen::SparseMatrix<double> matrix_;
};

}  // namespace lipofill::solid
