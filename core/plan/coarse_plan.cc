#include "core/plan/coarse_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/hash.h"
#include "core/geometry/hex_quality.h"
#include "core/geometry/node_values.h"
#include "core/plan/film_layout.h"
#include "core/plan/step_rules.h"

namespace lipofill::plan {
namespace {

using geometry::ChartPoint;
using geometry::LayeredGrid;
using geometry::ScalarField;

/// Divisions of a film for every one of the tissue are at least this: film_layout.cc refuses finer
/// cells.
constexpr int kLeastHexahedraAcross = 2;

/// An even number, so that films over the whole chart end where it does.
int coarsen_count(int n, double factor) {
  return std::max(2 * static_cast<int>(std::lround(n / factor / 2.0)), std::min(n, kLeastPreviewDivisions));
}

/// A level's position at a place of the chart, bilinear between its nodes.
Eigen::Vector3d sample_level(const LayeredGrid& grid, int level, const ChartPoint& place) {
  const double x = place.xi * grid.n_xi;
  const double y = place.eta * grid.n_eta;
  const int i = std::min(static_cast<int>(x), grid.n_xi - 1);
  const int j = std::min(static_cast<int>(y), grid.n_eta - 1);
  const double s = x - i;
  const double t = y - j;
  const auto at = [&](int di, int dj) { return grid.nodes.col(grid.node(level, i + di, j + dj)); };
  return (1 - t) * ((1 - s) * at(0, 0) + s * at(1, 0)) + t * ((1 - s) * at(0, 1) + s * at(1, 1));
}

LayeredGrid resample(const LayeredGrid& fine, int n_xi, int n_eta) {
  LayeredGrid coarse;
  coarse.n_xi = n_xi;
  coarse.n_eta = n_eta;
  coarse.elements_through = fine.elements_through;
  coarse.nodes.resize(3, static_cast<Eigen::Index>(coarse.n_levels()) * coarse.nodes_per_level());
  for (int level = 0; level < coarse.n_levels(); ++level) {
    for (int j = 0; j <= n_eta; ++j) {
      for (int i = 0; i <= n_xi; ++i) {
        const ChartPoint place{static_cast<double>(i) / n_xi, static_cast<double>(j) / n_eta};
        coarse.nodes.col(coarse.node(level, i, j)) = sample_level(fine, level, place);
      }
    }
  }
  if (coarse.n_layers() > 0) coarse.min_scaled_jacobian = geometry::find_worst_hexahedron(coarse).scaled_jacobian;
  return coarse;
}

/// A film's side on the coarse chart: from line to line of it, in whole cells.
struct Side {
  double low = 0.0;
  double high = 1.0;
  int n = 0;
};

/// The side that was [low, high] in `n` cells over `n_fine` hexahedra of the chart. It grows rather
/// than shrinks to hold whole cells, and stays in the chart.
Side coarsen_side(double low, double high, int n, int n_fine, int n_coarse) {
  const double fine_across = (high - low) * n_fine / n;
  const int across = std::clamp(static_cast<int>(std::lround(fine_across)), kLeastHexahedraAcross, n_coarse);
  const double quads = (high - low) * n_coarse;
  const int most = n_coarse / across;
  Side side;
  side.n = std::clamp(static_cast<int>(std::ceil(quads / across - 1e-6)), 1, most);
  const int first = std::clamp(static_cast<int>(std::lround(low * n_coarse)), 0, n_coarse - side.n * across);
  side.low = static_cast<double>(first) / n_coarse;
  side.high = static_cast<double>(first + side.n * across) / n_coarse;
  return side;
}

/// A film with walls of its own has no hexahedra to share edges with.
Side coarsen_free_side(double low, double high, int n) {
  return {low, high, std::max(1, static_cast<int>(std::lround(n / kPreviewCoarsening)))};
}

/// Means of a field over boxes of a film's cell size around points half a cell apart, which the
/// cells' centres are among.
ScalarField average_over_cells(const ScalarField& field, double width_xi, double width_eta) {
  if (field.values.size() == 1) return field;
  constexpr int kSamples = 8;
  ScalarField mean;
  mean.n_xi = 2 * std::max(1, static_cast<int>(std::lround(1.0 / width_xi))) + 1;
  mean.n_eta = 2 * std::max(1, static_cast<int>(std::lround(1.0 / width_eta))) + 1;
  mean.values.clear();
  for (int j = 0; j < mean.n_eta; ++j) {
    for (int i = 0; i < mean.n_xi; ++i) {
      double sum = 0.0;
      for (int b = 0; b < kSamples; ++b) {
        for (int a = 0; a < kSamples; ++a) {
          sum += field.at(static_cast<double>(i) / (mean.n_xi - 1) + width_xi * ((a + 0.5) / kSamples - 0.5),
                          static_cast<double>(j) / (mean.n_eta - 1) + width_eta * ((b + 0.5) / kSamples - 0.5));
        }
      }
      mean.values.push_back(sum / (kSamples * kSamples));
    }
  }
  return mean;
}

FilmSpec coarsen_film(const FilmSpec& given, const LayeredGrid& fine, const LayeredGrid& coarse) {
  const FilmSpec spec = with_cells(given, fine);
  const bool on_tissue = spec.wall == FilmWallKind::kTissue;
  const ChartBox& box = spec.extent;
  const Side xi = on_tissue ? coarsen_side(box.xi_min, box.xi_max, spec.n_xi, fine.n_xi, coarse.n_xi)
                            : coarsen_free_side(box.xi_min, box.xi_max, spec.n_xi);
  const Side eta = on_tissue ? coarsen_side(box.eta_min, box.eta_max, spec.n_eta, fine.n_eta, coarse.n_eta)
                             : coarsen_free_side(box.eta_min, box.eta_max, spec.n_eta);
  FilmSpec film = spec;
  film.extent = {xi.low, xi.high, eta.low, eta.high};
  film.n_xi = xi.n;
  film.n_eta = eta.n;
  const double width_xi = (xi.high - xi.low) / xi.n;
  const double width_eta = (eta.high - eta.low) / eta.n;
  film.rest_thickness = average_over_cells(spec.rest_thickness, width_xi, width_eta);
  if (spec.initial_thickness) film.initial_thickness = average_over_cells(*spec.initial_thickness, width_xi, width_eta);
  return film;
}

/// The centre of the zone's cell that is nearest to a site; the site itself where the zone has no
/// cell.
ChartPoint move_into_zone(const model::FaceModel& coarse, const std::vector<FilmSpec>& films, const std::string& zone,
                          const ChartPoint& site) {
  ChartPoint nearest = site;
  double least = std::numeric_limits<double>::infinity();
  for (const FilmSpec& spec : films) {
    const auto layout = place_film(coarse, spec);
    if (!layout.ok()) continue;
    for (int cell = 0; cell < layout->grid.n_cells(); ++cell) {
      if (layout->zone_names[layout->grid.zone_of_cell[cell]] != zone) continue;
      const ChartPoint centre = layout->cell_centre(cell);
      const double distance = std::hypot(centre.xi - site.xi, centre.eta - site.eta);
      if (distance < least) least = distance, nearest = centre;
    }
  }
  return nearest;
}

/// Returns the place of the point on the fine skin, or the point unchanged when it does not lie on
/// it.
geometry::SkinPoint fix_in_chart(const model::FaceModel& fine, const geometry::SkinPoint& point) {
  const auto place = geometry::locate_in_chart(fine.geometry, point);
  return place.ok() ? geometry::SkinPoint(*place) : point;
}

std::shared_ptr<const model::FaceModel> coarsen_by(const model::FaceModel& model, double factor) {
  const LayeredGrid& grid = model.geometry.grid;
  auto coarse = std::make_shared<model::FaceModel>();
  coarse->geometry.grid = resample(grid, coarsen_count(grid.n_xi, factor), coarsen_count(grid.n_eta, factor));
  coarse->geometry.axes = model.geometry.axes;
  coarse->geometry.landmarks = model.geometry.landmarks;
  coarse->geometry.skin_area = model.geometry.skin_area;
  coarse->layers = model.layers;
  coarse->rim = model.rim;
  coarse->base = model.base;
  if (model.base_give.size() > 0) {
    coarse->base_give =
        geometry::sample_at_nodes(geometry::field_of_nodes(model.base_give, grid), coarse->geometry.grid);
  }
  coarse->thickness = model.thickness;
  coarse->is_square = model.is_square;
  Hasher hasher;
  hasher.add("lipofill coarse model 1");
  hasher.add(model.content_hash);
  for (const int n : {coarse->geometry.grid.n_xi, coarse->geometry.grid.n_eta}) hasher.add(n);
  coarse->content_hash = hasher.hex_digest();
  return coarse;
}

}  // namespace

std::shared_ptr<const model::FaceModel> coarsen_model(const model::FaceModel& model) {
  const double hexahedra = model.geometry.grid.n_hexahedra();
  return coarsen_by(model, std::max(kPreviewCoarsening, std::sqrt(hexahedra / kMostPreviewHexahedra)));
}

std::shared_ptr<const model::FaceModel> halve_model(const model::FaceModel& model) {
  return coarsen_by(model, kPreviewCoarsening);
}

SimulationSpec coarsen_plan(const SimulationSpec& spec, const model::FaceModel& fine, const model::FaceModel& coarse) {
  SimulationSpec plan = spec;
  const TimeFigures figures = figures_of(TimeGoal::kSettledShape);
  plan.goal = TimeGoal::kSettledShape;
  plan.max_step = std::max(plan.step, *figures.max_step);
  plan.max_injection_step = std::max(plan.step, *figures.max_injection_step);
  plan.error_tolerance = std::max(spec.error_tolerance, figures.error_tolerance);
  plan.probes.clear();
  for (FilmSpec& film : plan.films) {
    film = coarsen_film(film, fine.geometry.grid, coarse.geometry.grid);
    for (WallSpec& wall : film.walls) {
      for (geometry::SkinPoint& point : wall.path) point = fix_in_chart(fine, point);
    }
  }
  for (LigamentSpec& ligament : plan.ligaments) {
    auto* points = std::get_if<std::vector<geometry::SkinPoint>>(&ligament.place);
    for (size_t k = 0; points != nullptr && k < points->size(); ++k) (*points)[k] = fix_in_chart(fine, (*points)[k]);
  }
  for (InjectionSpec& injection : plan.injections) {
    if (!injection.site) continue;
    const auto site = geometry::locate_in_chart(fine.geometry, *injection.site);
    if (site.ok()) injection.site = move_into_zone(coarse, plan.films, injection.zone, *site);
  }
  return plan;
}

}  // namespace lipofill::plan
