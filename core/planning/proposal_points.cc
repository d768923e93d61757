#include "core/planning/proposal_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lipofill::planning {
namespace {

using geometry::SurfaceMesh;

/// Nearest points this near to a corner or side of a triangle lie on it, in barycentric
/// coordinates.
constexpr double kOnEdge = 1e-7;
/// Points nearer to the target than this have the surface's normal for a direction [m].
constexpr double kTouching = 1e-7;
/// A Gaussian ends where it is this many lengths away.
constexpr double kTail = 3.0;

Eigen::VectorXd areas_of(const SurfaceMesh& patch) {
  Eigen::VectorXd area = Eigen::VectorXd::Zero(patch.points.cols());
  for (const auto& triangle : patch.triangles) {
    const double third = geometry::compute_area_vector(patch, triangle).norm() / 6.0;
    for (const int corner : triangle) area[corner] += third;
  }
  return area;
}

void place_on_nodes(const geometry::LayeredGrid& grid, SkinPoints& points) {
  for (const geometry::ChartPoint& place : points.place) {
    const double x = std::clamp(place.xi, 0.0, 1.0) * grid.n_xi;
    const double y = std::clamp(place.eta, 0.0, 1.0) * grid.n_eta;
    const int i = std::min(static_cast<int>(x), grid.n_xi - 1);
    const int j = std::min(static_cast<int>(y), grid.n_eta - 1);
    const double s = x - i, t = y - j;
    points.nodes.push_back({grid.surface_index(i, j), grid.surface_index(i + 1, j), grid.surface_index(i, j + 1),
                            grid.surface_index(i + 1, j + 1)});
    points.share.push_back({(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t});
  }
}

/// The triangles of which a corner lies in the box around the patch, grown by `reach`.
SurfaceMesh cut_near(const SurfaceMesh& target, const SurfaceMesh& patch, double reach) {
  const Eigen::Array3d low = patch.points.rowwise().minCoeff().array() - reach;
  const Eigen::Array3d high = patch.points.rowwise().maxCoeff().array() + reach;
  std::vector<bool> inside(static_cast<size_t>(target.n_vertices()));
  for (int v = 0; v < target.n_vertices(); ++v) {
    const Eigen::Array3d p = target.points.col(v).array();
    inside[static_cast<size_t>(v)] = (p >= low).all() && (p <= high).all();
  }
  std::vector<int> triangles;
  for (int t = 0; t < target.n_triangles(); ++t) {
    const auto& corners = target.triangles[static_cast<size_t>(t)];
    if (std::any_of(corners.begin(), corners.end(), [&](int v) { return inside[static_cast<size_t>(v)]; })) {
      triangles.push_back(t);
    }
  }
  return geometry::extract_triangles(target, triangles).mesh;
}

}  // namespace

Eigen::Matrix3Xd SkinPoints::gather(const Eigen::Matrix3Xd& on_nodes) const {
  Eigen::Matrix3Xd values = Eigen::Matrix3Xd::Zero(3, n());
  for (size_t k = 0; k < nodes.size(); ++k) {
    for (size_t corner = 0; corner < 4; ++corner) {
      values.col(static_cast<Eigen::Index>(k)) += share[k][corner] * on_nodes.col(nodes[k][corner]);
    }
  }
  return values;
}

SkinPoints make_node_points(const model::FaceModel& model) {
  const geometry::LayeredGrid& grid = model.geometry.grid;
  SkinPoints points;
  points.rest.points = grid.nodes.leftCols(grid.nodes_per_level());
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      points.place.push_back({static_cast<double>(i) / grid.n_xi, static_cast<double>(j) / grid.n_eta});
      if (i == grid.n_xi || j == grid.n_eta) continue;
      const int a = grid.surface_index(i, j), b = grid.surface_index(i + 1, j);
      const int c = grid.surface_index(i + 1, j + 1), d = grid.surface_index(i, j + 1);
      points.rest.triangles.push_back({a, b, c});
      points.rest.triangles.push_back({a, c, d});
    }
  }
  place_on_nodes(grid, points);
  points.area = areas_of(points.rest);
  return points;
}

SkinPoints make_skin_points(const model::FaceModel& model) {
  const SurfaceMesh& scan = model.geometry.scan;
  if (scan.n_vertices() == 0) return make_node_points(model);
  SkinPoints points;
  points.rest.points.resize(3, static_cast<Eigen::Index>(model.geometry.riders.size()));
  std::vector<int> rank(static_cast<size_t>(scan.n_vertices()), -1);
  for (const geometry::Rider& rider : model.geometry.riders) {
    const auto k = static_cast<Eigen::Index>(points.place.size());
    rank[static_cast<size_t>(rider.vertex)] = static_cast<int>(k);
    points.rest.points.col(k) = scan.points.col(rider.vertex);
    points.place.push_back(rider.place);
  }
  const auto rank_of = [&](int vertex) { return rank[static_cast<size_t>(vertex)]; };
  for (const auto& t : scan.triangles) {
    if (rank_of(t[0]) < 0 || rank_of(t[1]) < 0 || rank_of(t[2]) < 0) continue;
    points.rest.triangles.push_back({rank_of(t[0]), rank_of(t[1]), rank_of(t[2])});
  }
  place_on_nodes(model.geometry.grid, points);
  points.area = areas_of(points.rest);
  return points;
}

TargetDistance::TargetDistance(const SurfaceMesh& target, const SurfaceMesh& patch, double reach)
    : near_(cut_near(target, patch, reach)) {
  if (is_empty()) return;
  normals_ = geometry::compute_vertex_normals(near_);
  const geometry::Across across = geometry::find_neighbours(near_).across;
  is_border_.assign(static_cast<size_t>(near_.n_vertices()), false);
  for (size_t t = 0; t < near_.triangles.size(); ++t) {
    for (size_t side = 0; side < 3; ++side) {
      if (across[t][side] >= 0) continue;
      is_border_[static_cast<size_t>(near_.triangles[t][side])] = true;
      is_border_[static_cast<size_t>(near_.triangles[t][(side + 1) % 3])] = true;
    }
  }
  locator_ = std::make_unique<geometry::SurfaceLocator>(near_);
}

/// The sign is that of the normal between the triangle's corners; near the surface, where that
/// could be off at a crease, the distance is as small.
TargetSide TargetDistance::at(const Eigen::Vector3d& point) const {
  const geometry::SurfacePoint nearest = locator_->find_nearest(point);
  const auto& corners = near_.triangles[static_cast<size_t>(nearest.triangle)];
  const Eigen::Vector3d b = geometry::compute_barycentric(near_, nearest.triangle, nearest.position);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  TargetSide side;
  for (int k = 0; k < 3; ++k) {
    normal += b[k] * normals_.col(corners[static_cast<size_t>(k)]);
    const bool on_side = b[(k + 2) % 3] < kOnEdge;
    const bool from = is_border_[static_cast<size_t>(corners[static_cast<size_t>(k)])];
    const bool to = is_border_[static_cast<size_t>(corners[static_cast<size_t>((k + 1) % 3)])];
    if ((on_side && from && to) || (from && b[k] > 1.0 - kOnEdge)) side.is_off = true;
  }
  const Eigen::Vector3d away = point - nearest.position;
  const double sign = normal.dot(away) < 0.0 ? -1.0 : 1.0;
  side.distance = sign * nearest.distance;
  side.direction = nearest.distance > kTouching ? Eigen::Vector3d(sign * away / nearest.distance)
                                                : Eigen::Vector3d(normal.normalized());
  return side;
}

geometry::ScalarField smooth_deficit(const model::FaceModel& model, const TargetDistance& target, double length) {
  const geometry::LayeredGrid& grid = model.geometry.grid;
  const SkinPoints nodes = make_node_points(model);
  std::vector<double> deficit(static_cast<size_t>(nodes.n()), 0.0);
  std::vector<double> weight(static_cast<size_t>(nodes.n()), 0.0);
  for (Eigen::Index k = 0; k < nodes.n(); ++k) {
    const TargetSide side = target.at(nodes.rest.points.col(k));
    if (side.is_off) continue;
    deficit[static_cast<size_t>(k)] = -side.distance;
    weight[static_cast<size_t>(k)] = nodes.area[k];
  }
  const double width = std::sqrt(nodes.area.sum() / (grid.n_xi * grid.n_eta));
  const int reach = std::max(1, static_cast<int>(std::ceil(kTail * length / width)));
  geometry::ScalarField smooth{grid.n_xi + 1, grid.n_eta + 1, std::vector<double>(deficit.size(), 0.0)};
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      const int here = grid.surface_index(i, j);
      double sum = 0.0, total = 0.0;
      for (int b = std::max(0, j - reach); b <= std::min(grid.n_eta, j + reach); ++b) {
        for (int a = std::max(0, i - reach); a <= std::min(grid.n_xi, i + reach); ++a) {
          const int there = grid.surface_index(a, b);
          const double away = (nodes.rest.points.col(there) - nodes.rest.points.col(here)).norm() / length;
          if (away > kTail) continue;
          const double w = weight[static_cast<size_t>(there)] * std::exp(-0.5 * away * away);
          sum += w * deficit[static_cast<size_t>(there)];
          total += w;
        }
      }
      if (total > 0.0) smooth.values[static_cast<size_t>(here)] = sum / total;
    }
  }
  return smooth;
}

}  // namespace lipofill::planning
