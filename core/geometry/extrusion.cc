#include "core/geometry/extrusion.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "core/geometry/hex_quality.h"
#include "core/geometry/surface_chart.h"

namespace lipofill::geometry {
namespace {

constexpr double kSmallestScaledJacobian = 0.1;
constexpr double kGoodScaledJacobian = 0.5;
constexpr double kLeastCosine = 0.8;  // the thickness is corrected for tilts up to this cosine

/// Total depth of every level under every node, along the normal [m].
Eigen::MatrixXd compute_depths(const LayeredGrid& grid, const std::vector<LayerGeometry>& layers) {
  Eigen::MatrixXd depth = Eigen::MatrixXd::Zero(grid.nodes_per_level(), grid.n_levels());
  for (int l = 0; l < grid.n_layers(); ++l) {
    const int first = grid.first_level(l);
    const int n = grid.elements_through[l];
    for (int j = 0; j <= grid.n_eta; ++j) {
      for (int i = 0; i <= grid.n_xi; ++i) {
        const int node = grid.surface_index(i, j);
        const double thickness =
            layers[l].thickness.at(static_cast<double>(i) / grid.n_xi, static_cast<double>(j) / grid.n_eta);
        for (int k = 1; k <= n; ++k) depth(node, first + k) = depth(node, first) + thickness * k / n;
      }
    }
  }
  return depth;
}

void place_nodes(const Eigen::MatrixXd& depth, const Eigen::Matrix3Xd& normals, const Eigen::Matrix3Xd& directions,
                 LayeredGrid& grid) {
  const int n = grid.nodes_per_level();
  for (int level = 1; level < grid.n_levels(); ++level) {
    for (int node = 0; node < n; ++node) {
      const double cosine = std::max(normals.col(node).dot(directions.col(node)), kLeastCosine);
      grid.nodes.col(level * n + node) = grid.nodes.col(node) - depth(node, level) / cosine * directions.col(node);
    }
  }
}

int layer_of_level(const LayeredGrid& grid, int level) {
  int layer = 0;
  while (level >= grid.first_level(layer + 1)) ++layer;
  return layer;
}

/// Tries normals smoothed over longer and longer lengths and takes the first that gives well-shaped
/// hexahedra, or the best.
WorstHexahedron extrude_along_smoothed_normals(const Eigen::MatrixXd& depth, const Eigen::Vector2d& spacing,
                                               LayeredGrid& grid) {
  const Eigen::Matrix3Xd normals =
      compute_grid_normals(grid.n_xi, grid.n_eta, grid.nodes.leftCols(grid.nodes_per_level()));
  LayeredGrid best = grid;
  WorstHexahedron best_worst;
  best_worst.scaled_jacobian = -2.0;
  for (const double length : {0.0, 0.002, 0.004, 0.008, 0.016, 0.032}) {
    Eigen::Matrix3Xd directions = normals;
    smooth_over_grid(grid.n_xi, grid.n_eta, spacing, length, directions);
    directions.colwise().normalize();
    place_nodes(depth, normals, directions, grid);
    const WorstHexahedron worst = find_worst_hexahedron(grid);
    if (worst.scaled_jacobian > best_worst.scaled_jacobian) best = grid, best_worst = worst;
    if (best_worst.scaled_jacobian >= kGoodScaledJacobian) break;
  }
  grid = std::move(best);
  return best_worst;
}

}  // namespace

absl::StatusOr<LayeredGrid> extrude_layers(const Eigen::Matrix3Xd& skin, int n_xi, int n_eta,
                                           const std::vector<LayerGeometry>& layers,
                                           std::vector<Eigen::Vector3d>* folded) {
  LayeredGrid grid;
  grid.n_xi = n_xi;
  grid.n_eta = n_eta;
  for (const LayerGeometry& layer : layers) grid.elements_through.push_back(layer.elements_through);
  grid.nodes.resize(3, static_cast<Eigen::Index>(grid.n_levels()) * grid.nodes_per_level());
  grid.nodes.leftCols(grid.nodes_per_level()) = skin;
  if (layers.empty()) return grid;
  const Eigen::MatrixXd depth = compute_depths(grid, layers);
  const WorstHexahedron worst = extrude_along_smoothed_normals(depth, compute_mean_spacing(n_xi, n_eta, skin), grid);
  grid.min_scaled_jacobian = worst.scaled_jacobian;
  if (worst.scaled_jacobian >= kSmallestScaledJacobian) return grid;
  if (folded != nullptr) *folded = find_folded_places(grid, kSmallestScaledJacobian);
  return absl::FailedPreconditionError(
      absl::StrFormat("layers[%d] folds where the face curves: scaled Jacobian %.3f near (%.1f, %.1f, %.1f) mm, must "
                      "be at least %.1f; make the layers thinner there or take another region",
                      layer_of_level(grid, worst.level), worst.scaled_jacobian, worst.centre.x() * 1e3,
                      worst.centre.y() * 1e3, worst.centre.z() * 1e3, kSmallestScaledJacobian));
}

}  // namespace lipofill::geometry
