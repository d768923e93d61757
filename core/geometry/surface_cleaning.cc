#include "core/geometry/surface_cleaning.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/geometry/outer_wall.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

constexpr double kSamePlace = 1e-6;            // [m]
constexpr double kSpeckShareOfLargest = 0.02;  // a speck has less than this share of the area
constexpr int kMaxNonManifoldPasses = 20;

std::string counted(size_t n, const char* singular, const char* plural) {
  return absl::StrCat(n, " ", n == 1 ? singular : plural);
}

/// Returns for each vertex the first one at its place, on a lattice of a micrometre.
std::vector<int> find_first_at_place(const SurfaceMesh& mesh) {
  using Cell = std::array<int64_t, 3>;
  std::vector<std::pair<Cell, int>> places(mesh.n_vertices());
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    Cell cell;
    for (int c = 0; c < 3; ++c) cell[c] = std::llround(mesh.points(c, v) / kSamePlace);
    places[v] = {cell, v};
  }
  std::sort(places.begin(), places.end());
  std::vector<int> first(mesh.n_vertices());
  for (size_t begin = 0, k = 0; k < places.size(); ++k) {
    if (places[k].first != places[begin].first) begin = k;
    first[places[k].second] = places[begin].second;
  }
  return first;
}

void merge_vertices(SurfaceMesh& mesh, std::vector<int>& vertex_of_scan, std::vector<std::string>& remarks) {
  const std::vector<int> first = find_first_at_place(mesh);
  std::vector<bool> used(mesh.n_vertices(), false);
  for (auto& triangle : mesh.triangles) {
    for (int& v : triangle) used[v] = true, v = first[v];
  }
  size_t merged = 0;
  for (int v = 0; v < mesh.n_vertices(); ++v) {
    vertex_of_scan[v] = first[v];
    if (used[v] && first[v] != v) ++merged;
  }
  if (merged > 0) {
    remarks.push_back(absl::StrCat(counted(merged, "vertex", "vertices"), " at the place of another merged into it."));
  }
}

void drop_bad_triangles(SurfaceMesh& mesh, std::vector<std::string>& remarks) {
  const auto bad = [&](const auto& triangle) { return is_degenerate(mesh, triangle); };
  const size_t degenerate = std::erase_if(mesh.triangles, bad);
  if (degenerate > 0) {
    remarks.push_back(absl::StrCat(counted(degenerate, "triangle", "triangles"), " without area left out."));
  }
  std::vector<std::pair<std::array<int, 3>, int>> by_corners;
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    std::array<int, 3> corners = mesh.triangles[t];
    std::sort(corners.begin(), corners.end());
    by_corners.emplace_back(corners, t);
  }
  std::sort(by_corners.begin(), by_corners.end());
  std::vector<bool> repeated(mesh.triangles.size(), false);
  for (size_t k = 1; k < by_corners.size(); ++k) {
    repeated[by_corners[k].second] = by_corners[k].first == by_corners[k - 1].first;
  }
  int t = 0;
  const size_t repeats = std::erase_if(mesh.triangles, [&](const auto&) { return repeated[t++]; });
  if (repeats > 0) {
    remarks.push_back(absl::StrCat(counted(repeats, "triangle", "triangles"), " given more than once left out."));
  }
}

/// Measures how well two triangles at an edge continue each other: the cosine between their planes,
/// whichever way each is turned.
double smoothness_across(const SurfaceMesh& mesh, const EdgeUse& a, const EdgeUse& b) {
  const double turned = mesh.triangles[a.triangle][a.side] == mesh.triangles[b.triangle][b.side] ? -1.0 : 1.0;
  const Eigen::Vector3d na = compute_area_vector(mesh, mesh.triangles[a.triangle]).normalized();
  const Eigen::Vector3d nb = compute_area_vector(mesh, mesh.triangles[b.triangle]).normalized();
  return turned * na.dot(nb);
}

/// Marks all triangles at an over-full edge but the pair that continue each other best.
void mark_surplus(const SurfaceMesh& mesh, const EdgeUse* uses, size_t n, std::vector<bool>& surplus) {
  double best = -2.0;
  std::pair<size_t, size_t> smoothest{0, 1};
  for (size_t a = 0; a < n; ++a) {
    for (size_t b = a + 1; b < n; ++b) {
      const double smoothness = smoothness_across(mesh, uses[a], uses[b]);
      if (smoothness > best) best = smoothness, smoothest = {a, b};
    }
  }
  for (size_t k = 0; k < n; ++k) {
    if (k != smoothest.first && k != smoothest.second) surplus[uses[k].triangle] = true;
  }
}

void cut_non_manifold_edges(SurfaceMesh& mesh, std::vector<std::string>& remarks) {
  size_t edges = 0;
  size_t dropped = 0;
  for (int pass = 0; pass < kMaxNonManifoldPasses; ++pass) {
    const std::vector<EdgeUse> uses = sort_edge_uses(mesh);
    std::vector<bool> surplus(mesh.triangles.size(), false);
    size_t over_full = 0;
    for (size_t begin = 0; begin < uses.size();) {
      size_t end = begin + 1;
      while (end < uses.size() && uses[end].low == uses[begin].low && uses[end].high == uses[begin].high) ++end;
      // An edge with hundreds of triangles is noise, not skin: none of them is worth a search for
      // the best pair.
      constexpr size_t kMostSearched = 64;
      if (end - begin > 2) {
        ++over_full;
        mark_surplus(mesh, &uses[begin], std::min(end - begin, kMostSearched), surplus);
        for (size_t k = begin + kMostSearched; k < end; ++k) surplus[uses[k].triangle] = true;
      }
      begin = end;
    }
    if (over_full == 0) break;
    if (pass == 0) edges = over_full;
    int t = 0;
    dropped += std::erase_if(mesh.triangles, [&](const auto&) { return surplus[t++]; });
  }
  if (edges > 0) {
    remarks.push_back(absl::StrCat(counted(edges, "edge", "edges"),
                                   " of more than two triangles mended by leaving out ",
                                   counted(dropped, "triangle", "triangles"), "."));
  }
}

void drop_specks(SurfaceMesh& mesh, std::vector<std::string>& remarks) {
  const Components components = label_components(find_neighbours(mesh).across);
  if (components.count < 2) return;
  std::vector<double> area(components.count, 0.0);
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    area[components.label[t]] += 0.5 * compute_area_vector(mesh, mesh.triangles[t]).norm();
  }
  const double smallest_kept = kSpeckShareOfLargest * *std::max_element(area.begin(), area.end());
  const auto specks =
      static_cast<size_t>(std::count_if(area.begin(), area.end(), [&](double a) { return a < smallest_kept; }));
  if (specks == 0) return;
  int t = 0;
  const size_t dropped =
      std::erase_if(mesh.triangles, [&](const auto&) { return area[components.label[t++]] < smallest_kept; });
  remarks.push_back(absl::StrCat(counted(specks, "small loose part", "small loose parts"), " (",
                                 counted(dropped, "triangle", "triangles"), ") left out."));
}

/// True when the triangles beside side k of t run along it the same way, so that one of them must
/// be turned.
bool disagree(const SurfaceMesh& mesh, int t, int k, int neighbour) {
  const int from = mesh.triangles[t][k];
  const int to = mesh.triangles[t][(k + 1) % 3];
  for (int m = 0; m < 3; ++m) {
    if (mesh.triangles[neighbour][m] == from && mesh.triangles[neighbour][(m + 1) % 3] == to) return true;
  }
  return false;
}

/// Makes the triangles of each part agree with the majority of it.
void make_directions_agree(SurfaceMesh& mesh, std::vector<std::string>& remarks) {
  const Across across = find_neighbours(mesh).across;
  std::vector<int> turned(mesh.triangles.size(), -1);
  std::vector<int> part;
  size_t count = 0;
  for (int seed = 0; seed < mesh.n_triangles(); ++seed) {
    if (turned[seed] >= 0) continue;
    turned[seed] = 0;
    part.assign(1, seed);
    long long balance = 0;
    for (size_t k = 0; k < part.size(); ++k) {
      const int t = part[k];
      balance += turned[t] ? 1 : -1;
      for (int side = 0; side < 3; ++side) {
        const int neighbour = across[t][side];
        if (neighbour < 0 || turned[neighbour] >= 0) continue;
        turned[neighbour] = disagree(mesh, t, side, neighbour) ? 1 - turned[t] : turned[t];
        part.push_back(neighbour);
      }
    }
    for (const int t : part) turned[t] = balance > 0 ? 1 - turned[t] : turned[t];
  }
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    if (turned[t] == 1) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]), ++count;
  }
  if (count > 0) {
    remarks.push_back(
        absl::StrCat(counted(count, "triangle", "triangles"), " turned to face the way of those around."));
  }
}

/// A scan that was thickened for print, or is hollow, has its skin in the outer wall alone.
void keep_outer_wall(SurfaceMesh& mesh, std::vector<std::string>& remarks) {
  const auto shell = find_shell(mesh);
  if (!shell) return;
  size_t t = 0;
  std::erase_if(mesh.triangles, [&](const auto&) { return !shell->is_outer[t++]; });
  remarks.push_back(absl::StrFormat("The scan is a shell of two walls %.1f mm apart: its inner wall (%s) left out.",
                                    shell->thickness * 1e3, counted(shell->n_inner, "triangle", "triangles")));
  drop_specks(mesh, remarks);
}

void drop_unused_vertices(CleanedSurface& cleaned, const SurfaceMesh& scan) {
  std::vector<int> all(cleaned.mesh.triangles.size());
  for (size_t t = 0; t < all.size(); ++t) all[t] = static_cast<int>(t);
  SubSurface part = extract_triangles(cleaned.mesh, all);
  cleaned.mesh = std::move(part.mesh);
  for (int& v : cleaned.vertex_of_scan) v = part.vertex_of_whole[v];

  std::vector<bool> used(scan.n_vertices(), false);
  for (const auto& triangle : scan.triangles) {
    for (const int v : triangle) used[v] = true;
  }
  const auto unused = static_cast<size_t>(std::count(used.begin(), used.end(), false));
  if (unused > 0) {
    cleaned.remarks.push_back(absl::StrCat(counted(unused, "vertex", "vertices"), " of no triangle left out."));
  }
}

}  // namespace

CleanedSurface clean_surface(const SurfaceMesh& scan) {
  CleanedSurface cleaned;
  cleaned.mesh = scan;
  cleaned.vertex_of_scan.resize(scan.n_vertices());
  merge_vertices(cleaned.mesh, cleaned.vertex_of_scan, cleaned.remarks);
  drop_bad_triangles(cleaned.mesh, cleaned.remarks);
  cut_non_manifold_edges(cleaned.mesh, cleaned.remarks);
  drop_specks(cleaned.mesh, cleaned.remarks);
  make_directions_agree(cleaned.mesh, cleaned.remarks);
  keep_outer_wall(cleaned.mesh, cleaned.remarks);
  drop_unused_vertices(cleaned, scan);
  return cleaned;
}

}  // namespace lipofill::geometry
