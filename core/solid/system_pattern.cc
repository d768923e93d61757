#include "core/solid/system_pattern.h"

#include <algorithm>
#include <utility>

namespace lipofill::solid {
namespace {

template <class Nodes>
void couple(const Nodes& nodes, std::vector<std::vector<int>>& neighbours) {
  for (int a : nodes) {
    for (int b : nodes) {
      if (b > a) neighbours[a].push_back(b);
    }
  }
}

/// For each node the nodes from it upwards that share a hexahedron or a group with it, itself first, ascending.
std::vector<std::vector<int>> collect_upper_neighbours(int n_nodes, const std::vector<std::array<int, 8>>& hexahedra,
                                                       const std::vector<std::vector<int>>& groups) {
  std::vector<std::vector<int>> neighbours(n_nodes);
  for (int a = 0; a < n_nodes; ++a) neighbours[a].push_back(a);
  for (const std::array<int, 8>& hexahedron : hexahedra) couple(hexahedron, neighbours);
  for (const std::vector<int>& group : groups) couple(group, neighbours);
  for (std::vector<int>& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

int number_dofs(const std::vector<std::array<bool, 3>>& fixed, std::vector<int>& dof_of_component) {
  int n_dofs = 0;
  dof_of_component.clear();
  for (const std::array<bool, 3>& held : fixed) {
    for (int c = 0; c < 3; ++c) dof_of_component.push_back(held[c] ? -1 : n_dofs++);
  }
  return n_dofs;
}

}  // namespace

SystemPattern::SystemPattern(int n_nodes, const std::vector<std::array<int, 8>>& hexahedra,
                             const std::vector<std::array<bool, 3>>& fixed,
                             const std::vector<std::vector<int>>& groups) {
  const int n_dofs = number_dofs(fixed, dof_of_component_);
  const std::vector<std::vector<int>> neighbours = collect_upper_neighbours(n_nodes, hexahedra, groups);
  std::vector<int> starts = {0};
  std::vector<int> rows;
  for (int column_component = 0; column_component < 3 * n_nodes; ++column_component) {
    const int column = dof_of_component_[column_component];
    if (column < 0) continue;
    for (int b : neighbours[column_component / 3]) {
      for (int c = 0; c < 3; ++c) {
        const int row = dof_of_component_[3 * b + c];
        if (row >= column) rows.push_back(row);
      }
    }
    starts.push_back(static_cast<int>(rows.size()));
  }
  const std::vector<double> zeros(rows.size(), 0.0);
  matrix_ = Eigen::Map<const Eigen::SparseMatrix<double>>(n_dofs, n_dofs, static_cast<int>(rows.size()), starts.data(),
                                                          rows.data(), zeros.data());
}

int SystemPattern::find(int i, int j) const {
  const auto [column, row] = std::minmax(i, j);
  const int* const first = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column];
  const int* const last = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column + 1];
  return static_cast<int>(std::lower_bound(first, last, row) - matrix_.innerIndexPtr());
}

}  // namespace lipofill::solid
