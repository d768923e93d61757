#include "core/geometry/region_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();
constexpr double kSpare = 1.25;         // multiplies the corners' own sum; ways along edges are up to 1.2 too long
constexpr double kSpareLength = 0.005;  // [m] a corner
constexpr double kLargestFill = 0.015;  // [m] across
constexpr int kMaxPatchVertices = 300'000;

/// The vertices beside each vertex, as ranges of one array.
struct VertexGraph {
  std::vector<int> first;
  std::vector<int> beside;
};

VertexGraph make_vertex_graph(const SurfaceMesh& mesh) {
  VertexGraph graph;
  graph.first.assign(mesh.n_vertices() + 1, 0);
  std::vector<std::pair<int, int>> edges;
  for (const EdgeUse& use : sort_edge_uses(mesh)) {
    if (edges.empty() || edges.back() != std::pair{use.low, use.high}) edges.emplace_back(use.low, use.high);
  }
  for (const auto& [a, b] : edges) ++graph.first[a + 1], ++graph.first[b + 1];
  for (size_t v = 1; v < graph.first.size(); ++v) graph.first[v] += graph.first[v - 1];
  graph.beside.resize(edges.size() * 2);
  std::vector<int> next(graph.first.begin(), graph.first.end() - 1);
  for (const auto& [a, b] : edges) graph.beside[next[a]++] = b, graph.beside[next[b]++] = a;
  return graph;
}

bool holds(const SurfaceMesh& mesh, int triangle, const Eigen::Vector3d& position) {
  constexpr double kRoundOff = 1e-7;
  const Eigen::Vector3d weights = compute_barycentric(mesh, triangle, position);
  if (weights.minCoeff() < -kRoundOff) return false;
  const auto& c = mesh.triangles[triangle];
  const Eigen::Vector3d there =
      weights[0] * mesh.points.col(c[0]) + weights[1] * mesh.points.col(c[1]) + weights[2] * mesh.points.col(c[2]);
  return (there - position).norm() <= kRoundOff * std::sqrt(compute_area_vector(mesh, c).norm());
}

/// Vertices of the triangles that hold a point: of two where it lies on an edge, of all around
/// where it is a vertex. Which of them a search finds first is up to round-off.
std::vector<int> find_vertices_around(const SurfaceMesh& mesh, const SurfacePoint& point) {
  const auto& own = mesh.triangles[point.triangle];
  std::vector<int> around(own.begin(), own.end());
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const auto& other = mesh.triangles[t];
    const bool touches = std::any_of(other.begin(), other.end(),
                                     [&](int v) { return std::find(own.begin(), own.end(), v) != own.end(); });
    if (touches && holds(mesh, t, point.position)) around.insert(around.end(), other.begin(), other.end());
  }
  return around;
}

/// Distances along edges from a point to all vertices (Dijkstra); `around`: the vertices around the
/// point.
std::vector<double> compute_edge_distances(const SurfaceMesh& mesh, const VertexGraph& graph,
                                           const Eigen::Vector3d& source, const std::vector<int>& around) {
  std::vector<double> distance(mesh.n_vertices(), kUnreached);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  for (const int v : around) {
    distance[v] = (mesh.points.col(v) - source).norm();
    front.emplace(distance[v], v);
  }
  while (!front.empty()) {
    const auto [d, v] = front.top();
    front.pop();
    if (d > distance[v]) continue;
    for (int k = graph.first[v]; k < graph.first[v + 1]; ++k) {
      const int w = graph.beside[k];
      const double through_v = d + (mesh.points.col(w) - mesh.points.col(v)).norm();
      if (through_v >= distance[w]) continue;
      distance[w] = through_v;
      front.emplace(through_v, w);
    }
  }
  return distance;
}

/// Sum of the distances to the four corners, a value a vertex; the value at corner k in
/// `at_corner[k]`.
std::vector<double> add_up_distances(const SurfaceMesh& skin, const std::array<SurfacePoint, 4>& corners,
                                     std::array<double, 4>& at_corner) {
  const VertexGraph graph = make_vertex_graph(skin);
  std::vector<double> sum(skin.n_vertices(), 0.0);
  at_corner.fill(0.0);
  std::array<std::vector<int>, 4> around;
  for (size_t k = 0; k < corners.size(); ++k) around[k] = find_vertices_around(skin, corners[k]);
  for (size_t from = 0; from < corners.size(); ++from) {
    const std::vector<double> distance = compute_edge_distances(skin, graph, corners[from].position, around[from]);
    for (int v = 0; v < skin.n_vertices(); ++v) sum[v] += distance[v];
    for (size_t k = 0; k < corners.size(); ++k) {
      double nearest = kUnreached;
      for (const int v : around[k]) nearest = std::min(nearest, distance[v]);
      at_corner[k] += nearest;
    }
  }
  return sum;
}

absl::Status check_joined(const std::array<double, 4>& at_corner) {
  if (std::all_of(at_corner.begin(), at_corner.end(), [](double d) { return std::isfinite(d); }))
    return absl::OkStatus();
  return field_violation("scan_region.corners",
                         "lie on pieces of outer skin that do not hang together; all four must be on one");
}

/// Triangles with a vertex whose value is within the bound, the part of them that holds the seed.
std::vector<int> select_triangles(const SurfaceMesh& skin, const std::vector<double>& sum, double bound, int seed) {
  const auto within = [&](int t) {
    const auto& c = skin.triangles[t];
    return sum[c[0]] <= bound || sum[c[1]] <= bound || sum[c[2]] <= bound;
  };
  const Across across = find_neighbours(skin).across;
  std::vector<bool> taken(skin.triangles.size(), false);
  std::vector<int> selected{seed};
  taken[seed] = true;
  for (size_t k = 0; k < selected.size(); ++k) {
    for (const int neighbour : across[selected[k]]) {
      if (neighbour < 0 || taken[neighbour] || !within(neighbour)) continue;
      taken[neighbour] = true;
      selected.push_back(neighbour);
    }
  }
  std::sort(selected.begin(), selected.end());
  return selected;
}

double compute_length(const SurfaceMesh& mesh, const std::vector<int>& loop) {
  double length = 0.0;
  for (size_t k = 0; k < loop.size(); ++k) {
    length += (mesh.points.col(loop[(k + 1) % loop.size()]) - mesh.points.col(loop[k])).norm();
  }
  return length;
}

double compute_width(const SurfaceMesh& mesh, const std::vector<int>& loop) {
  Eigen::Vector3d low = mesh.points.col(loop.front());
  Eigen::Vector3d high = low;
  for (const int v : loop) low = low.cwiseMin(mesh.points.col(v)), high = high.cwiseMax(mesh.points.col(v));
  return (high - low).norm();
}

/// Closes a border by a fan from its middle. The border runs with its triangles, so the fan runs
/// against it.
void fill_hole(const std::vector<int>& loop, RegionPatch& patch) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const int v : loop) middle += patch.mesh.points.col(v);
  const int centre = patch.mesh.n_vertices();
  patch.mesh.points.conservativeResize(3, centre + 1);
  patch.mesh.points.col(centre) = middle / static_cast<double>(loop.size());
  patch.whole_of_vertex.push_back(-1);
  for (size_t k = 0; k < loop.size(); ++k) {
    patch.mesh.triangles.push_back({loop[(k + 1) % loop.size()], loop[k], centre});
  }
}

/// A hole whose fan would have triangles without area (a slit) is left open.
bool can_fill(const SurfaceMesh& mesh, const std::vector<int>& loop) {
  if (loop.size() < 3 || compute_width(mesh, loop) > kLargestFill) return false;
  RegionPatch trial;
  trial.mesh.points = mesh.points;
  fill_hole(loop, trial);
  return std::none_of(trial.mesh.triangles.begin(), trial.mesh.triangles.end(),
                      [&](const auto& triangle) { return is_degenerate(trial.mesh, triangle); });
}

/// All borders but the longest, which is the patch's own, are holes.
void fill_small_holes(RegionPatch& patch) {
  const auto loops = trace_boundary_loops(patch.mesh, find_neighbours(patch.mesh).across);
  size_t outermost = 0;
  for (size_t k = 1; k < loops.size(); ++k) {
    if (compute_length(patch.mesh, loops[k]) > compute_length(patch.mesh, loops[outermost])) outermost = k;
  }
  size_t filled = 0;
  double widest = 0.0;
  for (size_t k = 0; k < loops.size(); ++k) {
    if (k == outermost || !can_fill(patch.mesh, loops[k])) continue;
    widest = std::max(widest, compute_width(patch.mesh, loops[k]));
    fill_hole(loops[k], patch);
    ++filled;
  }
  if (filled > 0) {
    patch.remarks.push_back(absl::StrCat(filled, filled == 1 ? " hole" : " holes", " around the region filled, up to ",
                                         std::round(widest * 1e4) / 10.0, " mm across."));
  }
}

absl::Status check_size(const SurfaceMesh& patch) {
  if (patch.n_vertices() <= kMaxPatchVertices) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("the scan has ", patch.n_vertices(),
                                                    " vertices around the region, must have at most ",
                                                    kMaxPatchVertices, ": decimate it first"));
}

/// Tells how far each vertex lies beyond the nearest disc; not positive within.
std::vector<double> compute_distances_beyond(const SurfaceMesh& skin, const std::vector<SkinDisc>& discs) {
  const VertexGraph graph = make_vertex_graph(skin);
  std::vector<double> beyond(skin.n_vertices(), kUnreached);
  for (const SkinDisc& disc : discs) {
    const std::vector<double> distance =
        compute_edge_distances(skin, graph, disc.centre.position, find_vertices_around(skin, disc.centre));
    for (int v = 0; v < skin.n_vertices(); ++v) beyond[v] = std::min(beyond[v], distance[v] - disc.radius);
  }
  return beyond;
}

}  // namespace

absl::StatusOr<RegionPatch> cut_patch_around(const SurfaceMesh& skin, const std::vector<SkinDisc>& discs) {
  const std::vector<double> beyond = compute_distances_beyond(skin, discs);
  SubSurface part = extract_triangles(skin, select_triangles(skin, beyond, 0.0, discs.front().centre.triangle));
  if (const absl::Status size = check_size(part.mesh); !size.ok()) return size;
  RegionPatch patch;
  patch.mesh = std::move(part.mesh);
  patch.whole_of_vertex = std::move(part.whole_of_vertex);
  fill_small_holes(patch);
  return patch;
}

absl::StatusOr<RegionPatch> cut_region_patch(const SurfaceMesh& skin, const std::array<SurfacePoint, 4>& corners) {
  std::array<double, 4> at_corner{};
  const std::vector<double> sum = add_up_distances(skin, corners, at_corner);
  const absl::Status joined = check_joined(at_corner);
  if (!joined.ok()) return joined;
  const double bound = kSpare * *std::max_element(at_corner.begin(), at_corner.end()) + 4 * kSpareLength;
  SubSurface part = extract_triangles(skin, select_triangles(skin, sum, bound, corners[0].triangle));
  if (const absl::Status size = check_size(part.mesh); !size.ok()) return size;
  RegionPatch patch;
  patch.corners = corners;
  for (size_t k = 0; k < corners.size(); ++k) {
    const auto found =
        std::lower_bound(part.whole_of_triangle.begin(), part.whole_of_triangle.end(), corners[k].triangle);
    if (found == part.whole_of_triangle.end() || *found != corners[k].triangle) {
      return field_violation(absl::StrCat("scan_region.corners[", k, "]"),
                             "hangs together with the first corner only outside the region");
    }
    patch.corners[k].triangle = static_cast<int>(found - part.whole_of_triangle.begin());
  }
  patch.mesh = std::move(part.mesh);
  patch.whole_of_vertex = std::move(part.whole_of_vertex);
  fill_small_holes(patch);
  return patch;
}

}  // namespace lipofill::geometry
