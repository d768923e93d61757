#include "core/geometry/outer_wall.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "core/geometry/ray_tree.h"
#include "core/geometry/surface_locator.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

constexpr double kThickestShell = 0.010;  // [m]
constexpr double kShareOfShell = 0.6;     // of the area
constexpr double kRayStart = 2e-5;        // [m] off the surface, so that a ray does not meet its own triangle
constexpr int kFewestTriangles = 100;
constexpr int kMostSamples = 4000;
constexpr double kSharpestJoint = 0.5;  // cosine between the normals of triangles of one wall

/// This tells where the surface lies behind a triangle, or before it: whichever is nearer.
struct Opposite {
  double distance = std::numeric_limits<double>::infinity();  ///< [m]
  Eigen::Vector3d place = Eigen::Vector3d::Zero();            ///< where the ray meets it [m]
};

class WallFinder {
 public:
  explicit WallFinder(const SurfaceMesh& mesh) : mesh_(mesh), rays_(mesh) {
    for (const auto& triangle : mesh.triangles) {
      const Eigen::Vector3d twice_area = compute_area_vector(mesh, triangle);
      area_.push_back(0.5 * twice_area.norm());
      normal_.emplace_back(twice_area.normalized());
    }
  }

  std::optional<Shell> find();

 private:
  Opposite look_across(int t) const;
  std::optional<double> measure_thickness() const;
  Components join(const std::vector<bool>& member) const;
  std::vector<double> count_extremes() const;
  std::vector<std::map<int, double>> pair_walls() const;
  void colour_walls(const std::vector<std::map<int, double>>& pairs, const std::vector<double>& extremes);
  void grow_walls();
  void colour_triangles();
  void leave_out_rim();
  int stride() const { return std::max(1, mesh_.n_triangles() / kMostSamples); }

  const SurfaceMesh& mesh_;
  RayTree rays_;
  std::vector<double> area_;
  std::vector<Eigen::Vector3d> normal_;
  Across across_;
  std::vector<bool> has_wall_behind_;
  std::vector<int> wall_;  ///< of each triangle, -1 between walls
  int n_walls_ = 0;
  std::vector<bool> is_outer_wall_;
  std::vector<bool> is_outer_;  ///< a flag a triangle
};

Opposite WallFinder::look_across(int t) const {
  const auto& [a, b, c] = mesh_.triangles[static_cast<size_t>(t)];
  const Eigen::Vector3d centre = (mesh_.points.col(a) + mesh_.points.col(b) + mesh_.points.col(c)) / 3.0;
  Opposite nearest;
  for (const double way : {-1.0, 1.0}) {
    const Eigen::Vector3d direction = way * normal_[static_cast<size_t>(t)];
    const Eigen::Vector3d start = centre + kRayStart * direction;
    const double distance = rays_.find_first(start, direction, kThickestShell);
    if (distance < nearest.distance) nearest = {distance, start + distance * direction};
  }
  return nearest;
}

/// Median distance between the walls over a sample of the triangles; nothing where too few have a
/// wall behind them.
std::optional<double> WallFinder::measure_thickness() const {
  double all = 0.0;
  double paired = 0.0;
  std::vector<double> distances;
  for (int t = 0; t < mesh_.n_triangles(); t += stride()) {
    const double distance = look_across(t).distance;
    all += area_[static_cast<size_t>(t)];
    if (!std::isfinite(distance)) continue;
    paired += area_[static_cast<size_t>(t)];
    distances.push_back(distance);
  }
  if (distances.empty() || paired < kShareOfShell * all) return std::nullopt;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

/// Parts of the members among the triangles, joined over edges that do not bend sharply; label -1
/// for what is no member.
Components WallFinder::join(const std::vector<bool>& member) const {
  Components parts;
  parts.label.assign(member.size(), -1);
  std::vector<int> front;
  for (size_t seed = 0; seed < member.size(); ++seed) {
    if (!member[seed] || parts.label[seed] >= 0) continue;
    parts.label[seed] = parts.count;
    front.assign(1, static_cast<int>(seed));
    while (!front.empty()) {
      const auto t = static_cast<size_t>(front.back());
      front.pop_back();
      for (const int neighbour : across_[t]) {
        const auto n = static_cast<size_t>(neighbour);
        if (neighbour < 0 || !member[n] || parts.label[n] >= 0 || normal_[t].dot(normal_[n]) < kSharpestJoint) continue;
        parts.label[n] = parts.count;
        front.push_back(neighbour);
      }
    }
    ++parts.count;
  }
  return parts;
}

/// In how many of 218 directions each wall reaches farthest. A vertex of two walls has no say.
std::vector<double> WallFinder::count_extremes() const {
  constexpr int kNone = -1, kSeveral = -2;
  std::vector<int> wall_of_vertex(static_cast<size_t>(mesh_.n_vertices()), kNone);
  std::vector<bool> is_used(wall_of_vertex.size(), false);
  for (size_t t = 0; t < wall_.size(); ++t) {
    for (const int v : mesh_.triangles[t]) {
      int& wall = wall_of_vertex[static_cast<size_t>(v)];
      wall = wall == kNone || wall == wall_[t] ? wall_[t] : kSeveral;
      is_used[static_cast<size_t>(v)] = true;
    }
  }
  // Vertices of no triangle reach nowhere.
  Eigen::Matrix3Xd points = mesh_.points;
  for (Eigen::Index v = 0; v < points.cols(); ++v) {
    if (!is_used[static_cast<size_t>(v)]) points.col(v) = mesh_.points.col(mesh_.triangles[0][0]);
  }
  std::vector<double> extremes(static_cast<size_t>(n_walls_), 0.0);
  for (int x = -3; x <= 3; ++x) {
    for (int y = -3; y <= 3; ++y) {
      for (int z = -3; z <= 3; ++z) {
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) < 3) continue;
        Eigen::Index farthest = 0;
        (Eigen::RowVector3d(x, y, z) * points).maxCoeff(&farthest);
        const int wall = wall_of_vertex[static_cast<size_t>(farthest)];
        if (wall >= 0) extremes[static_cast<size_t>(wall)] += 1.0;
      }
    }
  }
  return extremes;
}

/// For each wall the area, over a sample, that has each other wall behind it.
std::vector<std::map<int, double>> WallFinder::pair_walls() const {
  std::vector<std::map<int, double>> pairs(static_cast<size_t>(n_walls_));
  const SurfaceLocator locator(mesh_);
  for (int t = 0; t < mesh_.n_triangles(); t += stride()) {
    const int wall = wall_[static_cast<size_t>(t)];
    if (wall < 0) continue;
    const int other = wall_[static_cast<size_t>(locator.find_nearest(look_across(t).place).triangle)];
    if (other < 0 || other == wall) continue;
    pairs[static_cast<size_t>(wall)][other] += area_[static_cast<size_t>(t)];
    pairs[static_cast<size_t>(other)][wall] += area_[static_cast<size_t>(t)];
  }
  return pairs;
}

/// Goes from the wall that reaches farthest to those behind it, which are inner, from these to the
/// ones behind them, and so on; the strongest pairs first.
void WallFinder::colour_walls(const std::vector<std::map<int, double>>& pairs, const std::vector<double>& extremes) {
  is_outer_wall_.assign(static_cast<size_t>(n_walls_), true);
  std::vector<bool> done(static_cast<size_t>(n_walls_), false);
  std::vector<int> order(static_cast<size_t>(n_walls_));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return extremes[static_cast<size_t>(a)] > extremes[static_cast<size_t>(b)]; });
  for (const int seed : order) {
    if (done[static_cast<size_t>(seed)]) continue;
    done[static_cast<size_t>(seed)] = true;
    std::vector<int> reached{seed};
    for (;;) {
      std::pair<int, int> best{-1, -1};
      double strongest = 0.0;
      for (const int wall : reached) {
        for (const auto& [other, area] : pairs[static_cast<size_t>(wall)]) {
          if (!done[static_cast<size_t>(other)] && area > strongest) strongest = area, best = {wall, other};
        }
      }
      if (best.second < 0) break;
      is_outer_wall_[static_cast<size_t>(best.second)] = !is_outer_wall_[static_cast<size_t>(best.first)];
      done[static_cast<size_t>(best.second)] = true;
      reached.push_back(best.second);
    }
  }
}

/// Lets the walls grow, all at once, over edges that do not bend sharply into what lies between
/// them: near the rim a ray passes the other wall by.
void WallFinder::grow_walls() {
  std::vector<int> front;
  for (size_t t = 0; t < wall_.size(); ++t) {
    if (wall_[t] >= 0) front.push_back(static_cast<int>(t));
  }
  for (size_t k = 0; k < front.size(); ++k) {
    const auto t = static_cast<size_t>(front[k]);
    for (const int neighbour : across_[t]) {
      const auto n = static_cast<size_t>(neighbour);
      if (neighbour < 0 || wall_[n] >= 0 || normal_[t].dot(normal_[n]) < kSharpestJoint) continue;
      wall_[n] = wall_[t];
      front.push_back(neighbour);
    }
  }
}

/// Parts that no wall grew into stay where they are joined to the outer wall alone.
void WallFinder::colour_triangles() {
  std::vector<bool> between(wall_.size());
  for (size_t t = 0; t < wall_.size(); ++t) {
    between[t] = wall_[t] < 0;
    is_outer_.push_back(wall_[t] >= 0 && is_outer_wall_[static_cast<size_t>(wall_[t])]);
  }
  const Components parts = join(between);
  std::vector<bool> touches_inner(static_cast<size_t>(parts.count), false);
  for (size_t t = 0; t < wall_.size(); ++t) {
    if (!between[t]) continue;
    for (const int n : across_[t]) {
      if (n >= 0 && !between[static_cast<size_t>(n)] && !is_outer_[static_cast<size_t>(n)])
        touches_inner[static_cast<size_t>(parts.label[t])] = true;
    }
  }
  for (size_t t = 0; t < wall_.size(); ++t) {
    if (between[t]) is_outer_[t] = !touches_inner[static_cast<size_t>(parts.label[t])];
  }
}

/// The rim has corners on both walls: it goes, also where it bends too little to be told from the
/// outer wall.
void WallFinder::leave_out_rim() {
  std::vector<bool> is_of_inner_wall(static_cast<size_t>(mesh_.n_vertices()), false);
  for (size_t t = 0; t < wall_.size(); ++t) {
    if (wall_[t] < 0 || is_outer_[t]) continue;
    for (const int v : mesh_.triangles[t]) is_of_inner_wall[static_cast<size_t>(v)] = true;
  }
  for (size_t t = 0; t < wall_.size(); ++t) {
    const auto& triangle = mesh_.triangles[t];
    const bool touches_inner =
        std::any_of(triangle.begin(), triangle.end(), [&](int v) { return is_of_inner_wall[static_cast<size_t>(v)]; });
    if (touches_inner) is_outer_[t] = false;
  }
}

std::optional<Shell> WallFinder::find() {
  const auto thickness = measure_thickness();
  if (!thickness) return std::nullopt;
  across_ = find_neighbours(mesh_).across;
  has_wall_behind_.resize(mesh_.triangles.size());
  for (int t = 0; t < mesh_.n_triangles(); ++t) {
    has_wall_behind_[static_cast<size_t>(t)] = look_across(t).distance <= 2.0 * *thickness;
  }
  const Components walls = join(has_wall_behind_);
  wall_ = walls.label;
  n_walls_ = walls.count;
  colour_walls(pair_walls(), count_extremes());
  grow_walls();
  colour_triangles();
  leave_out_rim();
  Shell shell;
  shell.thickness = *thickness;
  shell.n_inner = static_cast<size_t>(std::count(is_outer_.begin(), is_outer_.end(), false));
  shell.is_outer = std::move(is_outer_);
  if (shell.n_inner == 0 || shell.n_inner == shell.is_outer.size()) return std::nullopt;
  return shell;
}

}  // namespace

std::optional<Shell> find_shell(const SurfaceMesh& mesh) {
  if (mesh.n_triangles() < kFewestTriangles) return std::nullopt;
  return WallFinder(mesh).find();
}

}  // namespace lipofill::geometry
