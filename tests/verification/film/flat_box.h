#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/film/film_grid.h"
#include "core/film/film_metric.h"

namespace lipofill::verification {

/// A film over the rectangle (0, length_x) x (0, length_y), for cases that need a velocity to start
/// from: the public interface starts at rest.
struct FlatBox {
  film::FilmGrid grid;
  film::FilmMetric metric;

  FlatBox(int n_x, int n_y, double length_x, double length_y)
      : grid(film::make_film_grid({0, 1, 0, 1}, n_x, n_y, std::vector<int>(n_x * n_y, 0))) {
    Eigen::Matrix3Xd vertices(3, grid.n_vertices());
    for (int j = 0; j <= n_y; ++j) {
      for (int i = 0; i <= n_x; ++i) vertices.col(grid.vertex(i, j)) << length_x * i / n_x, length_y * j / n_y, 0.0;
    }
    metric = film::compute_film_metric(grid, vertices);
  }

  /// Edge velocities [m2/s] of the stream function psi: u = dpsi/dy, v = -dpsi/dx. Exact, and
  /// without divergence.
  Eigen::VectorXd flow_of(const std::function<double(double x, double y)>& psi) const {
    Eigen::VectorXd flow(grid.n_edges());
    const auto at = [&](int vertex) { return psi(metric.vertices(0, vertex), metric.vertices(1, vertex)); };
    for (int e = 0; e < grid.n_edges(); ++e) {
      const int slot = grid.slot_of_cell[grid.edges[e].right];
      const int i = grid.slot_i(slot);
      const int j = grid.slot_j(slot);
      const int other = grid.edges[e].direction == 0 ? grid.vertex(i, j + 1) : grid.vertex(i + 1, j);
      flow[e] = (grid.edges[e].direction == 0 ? 1.0 : -1.0) * (at(other) - at(grid.vertex(i, j)));
    }
    return flow;
  }

  /// The edge crossed along x at the left of slot (i, j).
  int x_edge(int i, int j) const { return grid.edge_of_side[grid.cell_of_slot[j * grid.n_xi + i]][film::kLowXi]; }
};

}  // namespace lipofill::verification
