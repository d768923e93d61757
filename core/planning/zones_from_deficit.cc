#include "core/planning/zones_from_deficit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"

namespace lipofill::planning {
namespace {

using geometry::LayeredGrid;

/// Outlines that are tried, as shares of the deficit in the middle of a hollow.
constexpr std::array<double, 3> kLevels = {0.2, 0.35, 0.5};
/// In two planes, of the deeper and of the other.
constexpr double kWide = 0.2;
constexpr double kNarrow = 0.5;
/// A zone of less is not worth an entry [m2].
constexpr double kLeastArea = 1e-4;
/// Between a zone and the rim of the model [m].
constexpr double kRim = 6e-3;

/// Areas that the nodes of the skin stand for [m2], and their distance from the rim along the
/// chart.
struct SkinNodes {
  Eigen::VectorXd area;
  Eigen::VectorXd to_rim;
};

SkinNodes measure_nodes(const LayeredGrid& grid) {
  SkinNodes nodes{Eigen::VectorXd::Zero(grid.nodes_per_level()), Eigen::VectorXd::Zero(grid.nodes_per_level())};
  const auto at = [&](int i, int j) { return Eigen::Vector3d(grid.nodes.col(grid.surface_index(i, j))); };
  double along_xi = 0.0, along_eta = 0.0;
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) along_xi += (at(i + 1, j) - at(i, j)).norm() / (grid.n_eta + 1);
  }
  for (int i = 0; i <= grid.n_xi; ++i) {
    for (int j = 0; j < grid.n_eta; ++j) along_eta += (at(i, j + 1) - at(i, j)).norm() / (grid.n_xi + 1);
  }
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      nodes.to_rim[grid.surface_index(i, j)] = std::min(along_xi * std::min(i, grid.n_xi - i) / grid.n_xi,
                                                        along_eta * std::min(j, grid.n_eta - j) / grid.n_eta);
      if (i == grid.n_xi || j == grid.n_eta) continue;
      const double quarter = 0.125 * (at(i + 1, j + 1) - at(i, j)).cross(at(i, j + 1) - at(i + 1, j)).norm();
      for (const auto& [a, b] : {std::pair(i, j), {i + 1, j}, {i, j + 1}, {i + 1, j + 1}}) {
        nodes.area[grid.surface_index(a, b)] += quarter;
      }
    }
  }
  return nodes;
}

/// Nodes joined along the lines of the grid, of those that are wanted.
std::vector<std::vector<int>> find_pieces(const LayeredGrid& grid, const std::vector<bool>& wanted) {
  std::vector<std::vector<int>> pieces;
  std::vector<bool> seen(wanted.size(), false);
  for (size_t start = 0; start < wanted.size(); ++start) {
    if (!wanted[start] || seen[start]) continue;
    std::vector<int> piece = {static_cast<int>(start)};
    seen[start] = true;
    for (size_t k = 0; k < piece.size(); ++k) {
      const int i = piece[k] % (grid.n_xi + 1), j = piece[k] / (grid.n_xi + 1);
      for (const auto& [a, b] : {std::pair(i - 1, j), {i + 1, j}, {i, j - 1}, {i, j + 1}}) {
        if (a < 0 || b < 0 || a > grid.n_xi || b > grid.n_eta) continue;
        const auto beside = static_cast<size_t>(grid.surface_index(a, b));
        if (!wanted[beside] || seen[beside]) continue;
        seen[beside] = true;
        piece.push_back(static_cast<int>(beside));
      }
    }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// A zone to be: where the cover is at least a half.
struct Hollow {
  double missing = 0.0;  ///< [m3]
  geometry::ScalarField cover;
};

/// The zone's cover: a half where the deficit is the threshold, or the rim is kRim away.
Hollow paint_hollow(const LayeredGrid& grid, const SkinNodes& nodes, const geometry::ScalarField& deficit,
                    const std::vector<int>& piece, const std::vector<bool>& inside, double threshold) {
  Hollow hollow;
  hollow.cover = {grid.n_xi + 1, grid.n_eta + 1, std::vector<double>(deficit.values.size(), 0.0)};
  std::vector<bool> is_own(inside.size(), false);
  for (const int node : piece) {
    is_own[static_cast<size_t>(node)] = true;
    hollow.missing += nodes.area[node] * deficit.values[static_cast<size_t>(node)];
  }
  for (size_t node = 0; node < inside.size(); ++node) {
    if (inside[node] && !is_own[node]) continue;
    const double by_deficit = 0.5 * deficit.values[node] / threshold;
    const double by_rim = 0.5 * nodes.to_rim[static_cast<Eigen::Index>(node)] / kRim;
    hollow.cover.values[node] = std::clamp(std::min(by_deficit, by_rim), 0.0, 1.0);
  }
  return hollow;
}

/// The film of a plan below a layer; one over the whole chart is added where there is none.
plan::FilmSpec& film_below(plan::SimulationSpec& plan, const std::string& layer) {
  for (plan::FilmSpec& film : plan.films) {
    if (film.below_layer == layer && film.wall == plan::FilmWallKind::kTissue) return film;
  }
  plan::FilmSpec film;
  film.name = "below_" + layer;
  film.below_layer = layer;
  plan.films.push_back(film);
  return plan.films.back();
}

/// A plane holds what is added in one plane.
struct Plane {
  std::string layer;
  double level = 0.0;
};

ZoneLayout make_layout(const model::FaceModel& model, const plan::SimulationSpec& plan,
                       const geometry::ScalarField& deficit, const ZoneProposals& proposals,
                       const std::vector<Plane>& planes) {
  ZoneLayout layout{"", plan, 0};
  std::vector<std::string> parts;
  for (const Plane& plane : planes) {
    const int room = proposals.max_zones / static_cast<int>(planes.size());
    auto zones = outline_hollows(model, deficit, plane.level, proposals.min_deficit, "below_" + plane.layer + "_");
    if (static_cast<int>(zones.size()) > room) zones.resize(static_cast<size_t>(room));
    if (zones.empty()) continue;
    layout.n_proposed += static_cast<int>(zones.size());
    plan::FilmSpec& film = film_below(layout.plan, plane.layer);
    film.zones.insert(film.zones.end(), zones.begin(), zones.end());
    if (!layout.description.empty()) layout.description += ", ";
    absl::StrAppend(&layout.description,
                    absl::StrFormat("%d below %s where at least %.0f %% are missing", static_cast<int>(zones.size()),
                                    plane.layer, 100.0 * plane.level));
  }
  return layout;
}

}  // namespace

std::vector<plan::ZoneSpec> outline_hollows(const model::FaceModel& model, const geometry::ScalarField& deficit,
                                            double level, double min_deficit, const std::string& prefix) {
  const LayeredGrid& grid = model.geometry.grid;
  const SkinNodes nodes = measure_nodes(grid);
  const auto n = static_cast<size_t>(grid.nodes_per_level());
  const auto wanted_above = [&](const std::vector<int>& among, double threshold) {
    std::vector<bool> wanted(n, false);
    for (const int node : among) {
      wanted[static_cast<size_t>(node)] =
          deficit.values[static_cast<size_t>(node)] >= threshold && nodes.to_rim[node] >= kRim;
    }
    return wanted;
  };
  std::vector<int> all(n);
  for (size_t node = 0; node < n; ++node) all[node] = static_cast<int>(node);
  std::vector<Hollow> hollows;
  for (const std::vector<int>& basin : find_pieces(grid, wanted_above(all, min_deficit))) {
    double deepest = 0.0;
    for (const int node : basin) deepest = std::max(deepest, deficit.values[static_cast<size_t>(node)]);
    const double threshold = std::max(min_deficit, level * deepest);
    const std::vector<bool> inside = wanted_above(basin, threshold);
    for (const std::vector<int>& piece : find_pieces(grid, inside)) {
      double area = 0.0;
      for (const int node : piece) area += nodes.area[node];
      if (area < kLeastArea) continue;
      hollows.push_back(paint_hollow(grid, nodes, deficit, piece, wanted_above(all, threshold), threshold));
    }
  }
  std::stable_sort(hollows.begin(), hollows.end(),
                   [](const Hollow& a, const Hollow& b) { return a.missing > b.missing; });
  std::vector<plan::ZoneSpec> zones;
  for (const Hollow& hollow : hollows) {
    zones.push_back({absl::StrCat(prefix, zones.size() + 1), plan::PaintedRegion{hollow.cover}});
  }
  return zones;
}

absl::StatusOr<std::vector<ZoneLayout>> list_zone_layouts(const model::FaceModel& model,
                                                          const plan::SimulationSpec& plan,
                                                          const geometry::ScalarField& deficit,
                                                          const ZoneProposals& proposals) {
  std::vector<std::string> layers;  // from the skin inwards, in which order planes are wide and narrow
  for (const model::TissueLayerSpec& layer : model.layers) {
    const auto& asked = proposals.below_layers;
    if (asked.empty() || std::find(asked.begin(), asked.end(), layer.name) != asked.end()) layers.push_back(layer.name);
  }
  FieldViolations violations;
  for (size_t k = 0; k < proposals.below_layers.size(); ++k) {
    const std::string& name = proposals.below_layers[k];
    if (std::find(layers.begin(), layers.end(), name) != layers.end()) continue;
    violations.add(absl::StrCat("zones.below_layers[", k, "]"), "is '" + name + "', which the model does not have");
  }
  if (!violations.empty()) return violations.to_status();
  std::vector<ZoneLayout> layouts;
  const auto add = [&](const std::vector<Plane>& planes) {
    ZoneLayout layout = make_layout(model, plan, deficit, proposals, planes);
    if (layout.n_proposed > 0) layouts.push_back(std::move(layout));
  };
  for (const std::string& layer : layers) {
    for (const double level : kLevels) add({{layer, level}});
  }
  for (size_t deep = 1; deep < layers.size() && proposals.max_zones > 1; ++deep) {
    for (size_t other = 0; other < deep; ++other) add({{layers[deep], kWide}, {layers[other], kNarrow}});
  }
  return layouts;
}

}  // namespace lipofill::planning
