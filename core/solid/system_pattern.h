#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <vector>

namespace lipofill::solid {

/// Numbering of the degrees of freedom and the lower triangle they couple in: node by node, fixed
/// components left out, every two nodes of a hexahedron coupled, and every two of a group. Depends
/// on its arguments only; time and memory linear in the hexahedra. Checked by
/// tests/unit/solid/element_batch_test.cc.
class SystemPattern {
 public:
  SystemPattern(int n_nodes, const std::vector<std::array<int, 8>>& hexahedra,
                const std::vector<std::array<bool, 3>>& fixed, const std::vector<std::vector<int>>& groups = {});

  int n_nodes() const { return static_cast<int>(free_.size()); }
  int n_dofs() const { return static_cast<int>(starts_.size()) - 1; }
  /// Degree of freedom of component c of node a at 3 a + c; -1 where fixed.
  const std::vector<int>& dof_of_component() const { return dof_of_component_; }
  /// Bit c: component c of the node is free.
  std::uint8_t free_components(int node) const { return free_[node]; }

  /// Values of the lower triangle.
  int n_values() const { return static_cast<int>(rows_.size()); }
  /// The pattern with values zero; columns ascending, rows ascending in each.
  Eigen::SparseMatrix<double> make_matrix() const;
  /// Returns the place of the value (max(i, j), min(i, j)); the nodes of the two must share a
  /// hexahedron or a group.
  int find(int i, int j) const;

  /// The triangle in blocks, one a pair of coupled nodes with free components: those of node b's
  /// columns are [block_starts()[b], block_starts()[b + 1]), its own first, and belong to the rows
  /// of block_rows(), ascending.
  int n_blocks() const { return static_cast<int>(block_rows_.size()); }
  const std::vector<int>& block_starts() const { return block_starts_; }
  const std::vector<int>& block_rows() const { return block_rows_; }
  /// The block of two coupled nodes; n_blocks() where one of them is held in all components.
  int find_block(int a, int b) const;

 private:
  void number_dofs(const std::vector<std::array<bool, 3>>& fixed);
  void couple_nodes(const std::vector<std::array<int, 8>>& hexahedra, const std::vector<std::vector<int>>& groups);
  void list_rows();

  std::vector<int> dof_of_component_;
  std::vector<std::uint8_t> free_;
  std::vector<int> block_starts_, block_rows_;
  std::vector<int> starts_, rows_;  ///< of the columns of scalars
};

}  // namespace lipofill::solid
