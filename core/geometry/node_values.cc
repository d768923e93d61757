#include "core/geometry/node_values.h"

namespace lipofill::geometry {

Eigen::VectorXd sample_at_nodes(const ScalarField& field, const LayeredGrid& grid) {
  Eigen::VectorXd values(grid.nodes_per_level());
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      values[grid.surface_index(i, j)] =
          field.at(static_cast<double>(i) / grid.n_xi, static_cast<double>(j) / grid.n_eta);
    }
  }
  return values;
}

ScalarField field_of_nodes(const Eigen::VectorXd& values, const LayeredGrid& grid) {
  return {grid.n_xi + 1, grid.n_eta + 1, {values.begin(), values.end()}};
}

}  // namespace lipofill::geometry
