#include "core/solid/system_pattern.h"

#include <algorithm>
#include <utility>

namespace lipofill::solid {
namespace {

/// The groups that each node is in, one list after the other: those of node a are [start[a],
/// start[a + 1]).
struct GroupsOfNodes {
  std::vector<int> start, group;
};

template <typename Groups>
GroupsOfNodes list_groups_of_nodes(int n_nodes, const Groups& groups) {
  GroupsOfNodes lists;
  lists.start.assign(n_nodes + 1, 0);
  for (const auto& nodes : groups) {
    for (const int a : nodes) ++lists.start[a + 1];
  }
  for (int a = 0; a < n_nodes; ++a) lists.start[a + 1] += lists.start[a];
  lists.group.resize(lists.start.back());
  std::vector<int> next(lists.start.begin(), lists.start.end() - 1);
  for (size_t k = 0; k < groups.size(); ++k) {
    for (const int a : groups[k]) lists.group[next[a]++] = static_cast<int>(k);
  }
  return lists;
}

}  // namespace

SystemPattern::SystemPattern(int n_nodes, const std::vector<std::array<int, 8>>& hexahedra,
                             const std::vector<std::array<bool, 3>>& fixed,
                             const std::vector<std::vector<int>>& groups) {
  free_.assign(n_nodes, 0);
  number_dofs(fixed);
  couple_nodes(hexahedra, groups);
  list_rows();
}

void SystemPattern::number_dofs(const std::vector<std::array<bool, 3>>& fixed) {
  int n_dofs = 0;
  for (int a = 0; a < n_nodes(); ++a) {
    for (int c = 0; c < 3; ++c) {
      dof_of_component_.push_back(fixed[a][c] ? -1 : n_dofs++);
      if (!fixed[a][c]) free_[a] = static_cast<std::uint8_t>(free_[a] | (1 << c));
    }
  }
  starts_.reserve(n_dofs + 1);
}

void SystemPattern::couple_nodes(const std::vector<std::array<int, 8>>& hexahedra,
                                 const std::vector<std::vector<int>>& groups) {
  const GroupsOfNodes hexahedra_of = list_groups_of_nodes(n_nodes(), hexahedra);
  const GroupsOfNodes groups_of = list_groups_of_nodes(n_nodes(), groups);
  std::vector<int> seen_by(n_nodes(), -1);
  block_starts_ = {0};
  for (int b = 0; b < n_nodes(); ++b) {
    const auto add = [&](const auto& nodes) {
      for (const int a : nodes) {
        if (a < b || seen_by[a] == b || free_[a] == 0) continue;
        seen_by[a] = b;
        block_rows_.push_back(a);
      }
    };
    if (free_[b] != 0) {
      add(std::array<int, 1>{b});
      for (int k = hexahedra_of.start[b]; k < hexahedra_of.start[b + 1]; ++k) add(hexahedra[hexahedra_of.group[k]]);
      for (int k = groups_of.start[b]; k < groups_of.start[b + 1]; ++k) add(groups[groups_of.group[k]]);
      std::sort(block_rows_.begin() + block_starts_.back(), block_rows_.end());
    }
    block_starts_.push_back(n_blocks());
  }
}

void SystemPattern::list_rows() {
  starts_ = {0};
  for (int b = 0; b < n_nodes(); ++b) {
    for (int j = 0; j < 3; ++j) {
      const int column = dof_of_component_[3 * b + j];
      if (column < 0) continue;
      for (int k = block_starts_[b]; k < block_starts_[b + 1]; ++k) {
        for (int i = 0; i < 3; ++i) {
          const int row = dof_of_component_[3 * block_rows_[k] + i];
          if (row >= column) rows_.push_back(row);
        }
      }
      starts_.push_back(n_values());
    }
  }
}

Eigen::SparseMatrix<double> SystemPattern::make_matrix() const {
  Eigen::SparseMatrix<double> matrix(n_dofs(), n_dofs());
  matrix.resizeNonZeros(n_values());
  std::copy(starts_.begin(), starts_.end(), matrix.outerIndexPtr());
  std::copy(rows_.begin(), rows_.end(), matrix.innerIndexPtr());
  matrix.coeffs().setZero();
  return matrix;
}

int SystemPattern::find(int i, int j) const {
  const auto [column, row] = std::minmax(i, j);
  const auto first = rows_.begin() + starts_[column];
  const auto last = rows_.begin() + starts_[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - rows_.begin());
}

int SystemPattern::find_block(int a, int b) const {
  if (free_[a] == 0 || free_[b] == 0) return n_blocks();
  const auto [column, row] = std::minmax(a, b);
  const auto first = block_rows_.begin() + block_starts_[column];
  const auto last = block_rows_.begin() + block_starts_[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - block_rows_.begin());
}

}  // namespace lipofill::solid
