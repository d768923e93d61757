#include "core/plan/zone_feather.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/plan/zone_distance.h"

namespace lipofill::plan {

using geometry::ChartPoint;
using geometry::ScalarField;

ScalarField find_signed_distance(const geometry::LayeredGrid& grid, const DrawnZone& zone) {
  const ZoneDistance distance(grid, zone.outline);
  ScalarField field{2 * grid.n_xi + 1, 2 * grid.n_eta + 1, {}};
  field.values.reserve(static_cast<size_t>(field.n_xi) * field.n_eta);
  for (int j = 0; j < field.n_eta; ++j) {
    for (int i = 0; i < field.n_xi; ++i) {
      const ChartPoint place{static_cast<double>(i) / (field.n_xi - 1), static_cast<double>(j) / (field.n_eta - 1)};
      const double away =
          distance.to_outline(geometry::skin_position(grid, place), std::numeric_limits<double>::infinity());
      field.values.push_back(zone.level(place) >= 0.0 ? away : -away);
    }
  }
  return field;
}

std::vector<geometry::Level> feather(const std::vector<DrawnZone>& zones, const std::vector<ScalarField>& distances,
                                     const std::vector<double>& widths) {
  std::vector<geometry::Level> levels;
  for (size_t z = 0; z < zones.size(); ++z) {
    if (widths[z] <= 0.0) {
      levels.push_back(zones[z].level);
      continue;
    }
    levels.emplace_back([drawn = zones[z].level, distances, width = widths[z], z](const ChartPoint& p) {
      const double own = distances[z].at(p.xi, p.eta);
      double beyond = width + own;
      for (size_t other = 0; other < distances.size(); ++other) {
        if (other != z) beyond = std::min(beyond, own - distances[other].at(p.xi, p.eta));
      }
      return std::max(drawn(p), beyond);
    });
  }
  return levels;
}

double measure_cut_feather(const geometry::LayeredGrid& grid, const geometry::ChartBox& extent,
                           const ScalarField& distance, double width) {
  const std::array<ChartPoint, 4> corners = {ChartPoint{extent.xi_min, extent.eta_min},
                                             {extent.xi_max, extent.eta_min},
                                             {extent.xi_max, extent.eta_max},
                                             {extent.xi_min, extent.eta_max}};
  const int n = 2 * std::max(grid.n_xi, grid.n_eta);
  double length = 0.0;
  for (size_t side = 0; side < corners.size(); ++side) {
    const ChartPoint& from = corners[side];
    const ChartPoint& to = corners[(side + 1) % corners.size()];
    const auto along = [&](double share) {
      return ChartPoint{from.xi + share * (to.xi - from.xi), from.eta + share * (to.eta - from.eta)};
    };
    for (int k = 0; k < n; ++k) {
      const ChartPoint middle = along((k + 0.5) / n);
      const double away = -distance.at(middle.xi, middle.eta);
      if (away <= 0.0 || away >= width) continue;
      length += (geometry::skin_position(grid, along((k + 1.0) / n)) -
                 geometry::skin_position(grid, along(static_cast<double>(k) / n)))
                    .norm();
    }
  }
  return length;
}

}  // namespace lipofill::plan
