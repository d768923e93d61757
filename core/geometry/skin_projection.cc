#include "core/geometry/skin_projection.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"

namespace lipofill::geometry {
namespace {

struct Cell {
  int i = 0;
  int j = 0;
};

/// The bilinear cell's position at local coordinates (r, s) and its derivatives.
struct CellPoint {
  Eigen::Vector3d position;
  Eigen::Matrix<double, 3, 2> tangents;
  Eigen::Vector3d twist;
};

CellPoint evaluate(const LayeredGrid& grid, const Cell& cell, double r, double s) {
  const Eigen::Vector3d a = grid.nodes.col(grid.surface_index(cell.i, cell.j));
  const Eigen::Vector3d b = grid.nodes.col(grid.surface_index(cell.i + 1, cell.j)) - a;
  const Eigen::Vector3d c = grid.nodes.col(grid.surface_index(cell.i, cell.j + 1)) - a;
  const Eigen::Vector3d d = grid.nodes.col(grid.surface_index(cell.i + 1, cell.j + 1)) - a - b - c;
  CellPoint point;
  point.position = a + r * b + s * c + r * s * d;
  point.tangents << b + s * d, c + r * d;
  point.twist = d;
  return point;
}

/// Local coordinates of the foot of a point in a cell continued bilinearly. It stays near the cell:
/// far out, a bilinear cell turns over.
Eigen::Vector2d find_foot(const LayeredGrid& grid, const Cell& cell, const Eigen::Vector3d& point, Eigen::Vector2d rs) {
  constexpr int kMaxIterations = 20;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const CellPoint at = evaluate(grid, cell, rs.x(), rs.y());
    const Eigen::Vector3d gap = point - at.position;
    Eigen::Matrix2d hessian = at.tangents.transpose() * at.tangents;
    const Eigen::Matrix2d gauss_newton = hessian;
    const double bend = gap.dot(at.twist);
    hessian(0, 1) -= bend;
    hessian(1, 0) -= bend;
    if (!(hessian.determinant() > 0.1 * gauss_newton.determinant())) hessian = gauss_newton;
    const Eigen::Vector2d step = hessian.ldlt().solve(at.tangents.transpose() * gap);
    if (!step.allFinite()) break;
    rs = (rs + step).cwiseMax(-2.0).cwiseMin(3.0);
    if (step.norm() < 1e-13) break;
  }
  return rs;
}

}  // namespace

SkinProjection::SkinProjection(const LayeredGrid& grid) : grid_(grid) {
  facets_.points = grid.nodes.leftCols(grid.nodes_per_level());
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) {
      const int a = grid.surface_index(i, j);
      const int d = grid.surface_index(i, j + 1);
      facets_.triangles.push_back({a, a + 1, d + 1});
      facets_.triangles.push_back({a, d + 1, d});
    }
  }
  locator_ = std::make_unique<SurfaceLocator>(facets_);
}

SkinFoot SkinProjection::project(const Eigen::Vector3d& point) const {
  constexpr double kSlack = 1e-9;
  constexpr int kMaxMoves = 8;
  const int facet = locator_->find_nearest(point).triangle;
  Cell cell{(facet / 2) % grid_.n_xi, (facet / 2) / grid_.n_xi};
  Eigen::Vector2d rs(0.5, 0.5);
  for (int move = 0; move < kMaxMoves; ++move) {
    rs = find_foot(grid_, cell, point, rs);
    const Cell next{std::clamp(cell.i + (rs.x() > 1.0 + kSlack) - (rs.x() < -kSlack), 0, grid_.n_xi - 1),
                    std::clamp(cell.j + (rs.y() > 1.0 + kSlack) - (rs.y() < -kSlack), 0, grid_.n_eta - 1)};
    if (next.i == cell.i && next.j == cell.j) break;
    // At a crease the feet in the two cells can each lie in the other: the last cell and its edge
    // are then the answer.
    rs = Eigen::Vector2d(rs.x() - (next.i - cell.i), rs.y() - (next.j - cell.j)).cwiseMax(0.0).cwiseMin(1.0);
    cell = next;
  }
  const auto settle = [](double x, int k, int n) {
    return k > 0 && k < n - 1 ? std::clamp(x, 0.0, 1.0) : k > 0 ? std::max(x, 0.0) : k < n - 1 ? std::min(x, 1.0) : x;
  };
  SkinFoot foot;
  foot.place.xi = (cell.i + settle(rs.x(), cell.i, grid_.n_xi)) / grid_.n_xi;
  foot.place.eta = (cell.j + settle(rs.y(), cell.j, grid_.n_eta)) / grid_.n_eta;
  const ChartPoint inside{std::clamp(foot.place.xi, 0.0, 1.0), std::clamp(foot.place.eta, 0.0, 1.0)};
  foot.distance = (skin_position(grid_, inside) - point).norm();
  return foot;
}

Eigen::Vector3d skin_position(const LayeredGrid& grid, const ChartPoint& place) {
  const double x = std::clamp(place.xi, 0.0, 1.0) * grid.n_xi;
  const double y = std::clamp(place.eta, 0.0, 1.0) * grid.n_eta;
  const Cell cell{std::min(static_cast<int>(x), grid.n_xi - 1), std::min(static_cast<int>(y), grid.n_eta - 1)};
  return evaluate(grid, cell, x - cell.i, y - cell.j).position;
}

namespace {

absl::StatusOr<Eigen::Vector3d> resolve_landmark_point(const LandmarkPoint& point, const Landmarks& landmarks,
                                                       const HeadAxes& axes) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0.0;
  for (const auto& [name, weight] : point.weights) {
    const auto landmark = landmarks.find(name);
    if (landmark == landmarks.end()) {
      return field_violation("", absl::StrCat("names the landmark '", name, "', which is not among those given"));
    }
    sum += weight * landmark->second;
    total += weight;
  }
  if (!(std::abs(total) > 1e-9)) {
    return field_violation("", absl::StrCat("has landmark weights that add up to ", total, ", must not be 0"));
  }
  return Eigen::Vector3d(sum / total + point.left * axes.left + point.up * axes.up + point.forward * axes.forward);
}

}  // namespace

absl::StatusOr<Eigen::Vector3d> resolve_position(const SkinPoint& point, const Landmarks& landmarks,
                                                 const HeadAxes& axes) {
  if (std::holds_alternative<ChartPoint>(point)) {
    return field_violation("", "is a chart point, where only a position or landmarks make sense");
  }
  absl::StatusOr<Eigen::Vector3d> position = Eigen::Vector3d::Zero().eval();
  if (const auto* given = std::get_if<Eigen::Vector3d>(&point)) {
    position = *given;
  } else {
    position = resolve_landmark_point(std::get<LandmarkPoint>(point), landmarks, axes);
  }
  if (position.ok() && !position->allFinite()) return field_violation("", "is not a finite position");
  return position;
}

absl::StatusOr<ChartPoint> locate_in_chart(const FaceGeometry& geometry, const SkinPoint& point) {
  constexpr double kRimTolerance = 1e-6;
  ChartPoint place;
  if (const auto* given = std::get_if<ChartPoint>(&point)) {
    place = *given;
  } else {
    const auto position = resolve_position(point, geometry.landmarks, geometry.axes);
    if (!position.ok()) return position.status();
    const SkinProjection projection(geometry.grid);
    SkinFoot foot = projection.project(*position);
    if (foot.distance > kFarthestFromSkin && std::holds_alternative<LandmarkPoint>(point)) {
      // A mean of landmarks may lie deep under the skin.
      if (const auto reached = SkinReach(projection.facets()).reach(*position))
        foot = projection.project(reached->position);
    }
    place = foot.place;
    const bool over_the_region = std::max(std::abs(place.xi - 0.5), std::abs(place.eta - 0.5)) <= 0.5 + kRimTolerance;
    if (over_the_region && foot.distance > kFarthestFromSkin) {
      return field_violation("", absl::StrFormat("lies %.1f mm from the outer skin, must be at most %.0f mm",
                                                 foot.distance * 1e3, kFarthestFromSkin * 1e3));
    }
  }
  for (double* coordinate : {&place.xi, &place.eta}) {
    if (!(*coordinate >= -kRimTolerance && *coordinate <= 1.0 + kRimTolerance)) {
      return field_violation(
          "", absl::StrFormat("lies outside the region, at (xi, eta) = (%.4f, %.4f), must be in [0, 1]", place.xi,
                              place.eta));
    }
    *coordinate = std::clamp(*coordinate, 0.0, 1.0);
  }
  return place;
}

}  // namespace lipofill::geometry
