#include "core/plan/film_layout.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/anatomy/regions.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/plan/film_walls.h"

namespace lipofill::plan {
namespace {

constexpr int kMaxFilmCells = 65536;
constexpr double kCoarsestRatio = 2.0;
constexpr double kThickest_mm = 50.0;

void check_box(const ChartBox& box, const std::string& field, FieldViolations& violations) {
  violations.check_range(field + ".xi_min", box.xi_min, 0.0, 1.0, "");
  violations.check_range(field + ".xi_max", box.xi_max, 0.0, 1.0, "");
  violations.check_range(field + ".eta_min", box.eta_min, 0.0, 1.0, "");
  violations.check_range(field + ".eta_max", box.eta_max, 0.0, 1.0, "");
  if (!(box.xi_min < box.xi_max))
    violations.add(field + ".xi_max", absl::StrCat("is ", box.xi_max, ", must be above xi_min ", box.xi_min));
  if (!(box.eta_min < box.eta_max))
    violations.add(field + ".eta_max", absl::StrCat("is ", box.eta_max, ", must be above eta_min ", box.eta_min));
}

void check_thickness(const geometry::ScalarField& field, const std::string& name, double lowest,
                     FieldViolations& violations) {
  const absl::Status status = field.validate();
  violations.absorb(name, status);
  if (!status.ok()) return;
  violations.check_range(name, field.minimum() / kMetresPerMillimetre, lowest, kThickest_mm, "mm");
  violations.check_range(name, field.maximum() / kMetresPerMillimetre, lowest, kThickest_mm, "mm");
}

void check_grid_counts(const FilmSpec& spec, FieldViolations& violations) {
  violations.check_range("n_xi", spec.n_xi, 1, kMaxFilmCells, "cells");
  violations.check_range("n_eta", spec.n_eta, 1, kMaxFilmCells, "cells");
  if (static_cast<int64_t>(spec.n_xi) * spec.n_eta > kMaxFilmCells) {
    violations.add("n_xi", absl::StrCat("times n_eta is ", static_cast<int64_t>(spec.n_xi) * spec.n_eta,
                                        " cells, must be at most ", kMaxFilmCells));
  }
}

void check_connective_tissue(const FilmSpec& spec, FieldViolations& violations) {
  const ConnectiveTissueSpec& fibres = spec.connective_tissue;
  violations.check_range("connective_tissue.stiffness_kpa_per_mm",
                         fibres.stiffness / kPascalsPerMetrePerKilopascalPerMillimetre, 0.0, 1e6, "kPa/mm");
  violations.check_range("connective_tissue.entry_pressure_pa", fibres.entry_pressure, 0.0, 1e7, "Pa");
  if (fibres.stiffness > 0.0 && spec.wall != FilmWallKind::kTissue) {
    violations.add("connective_tissue.stiffness_kpa_per_mm", "is given, but only films on tissue have fibres");
  }
  if (fibres.entry_pressure > 0.0 && spec.wall == FilmWallKind::kRigid) {
    violations.add("connective_tissue.entry_pressure_pa", "is given, but nothing gives way between rigid walls");
  }
}

/// One pressure a cell cannot hold a wall whose quadrilaterals are as fine as the cells: it would
/// ripple between them.
void check_coarseness(const char* field, double span, int n_film, int n_tissue, FieldViolations& violations) {
  const double ratio = span * n_tissue / n_film;
  if (ratio >= kCoarsestRatio - 1e-9) return;
  violations.add(
      field, absl::StrCat("is ", n_film, ": a film cell spans ", ratio, " hexahedra of the tissue, must span at least ",
                          kCoarsestRatio, " (at most ", static_cast<int>(span * n_tissue / kCoarsestRatio), " cells)"));
}

/// The tissue level a film lies at, under the layer it names.
int find_level(const model::FaceModel& model, const FilmSpec& spec, FieldViolations& violations) {
  for (size_t l = 0; l < model.layers.size(); ++l) {
    if (model.layers[l].name == spec.below_layer) return model.geometry.grid.first_level(static_cast<int>(l) + 1);
  }
  std::vector<std::string> names;
  for (const model::TissueLayerSpec& layer : model.layers) names.push_back(layer.name);
  std::string known;
  for (const std::string& name : names) absl::StrAppend(&known, known.empty() ? "" : ", ", name);
  violations.add("below_layer", absl::StrCat("is '", spec.below_layer, "', must be one of the model's layers: ",
                                             known.empty() ? "it has none" : known));
  return -1;
}

using Membership = std::function<bool(const geometry::ChartPoint&)>;

absl::StatusOr<Membership> make_membership(const model::FaceModel& model, const ZoneSpec& zone) {
  const geometry::FaceGeometry& face = model.geometry;
  if (const auto* box = std::get_if<ChartBox>(&zone.shape)) {
    FieldViolations violations;
    check_box(*box, "box", violations);
    if (!violations.empty()) return violations.to_status();
    return Membership([b = *box](const geometry::ChartPoint& p) {
      return p.xi >= b.xi_min && p.xi <= b.xi_max && p.eta >= b.eta_min && p.eta <= b.eta_max;
    });
  }
  if (const auto* disc = std::get_if<Disc>(&zone.shape)) {
    FieldViolations violations;
    violations.check_range("disc.radius_mm", disc->radius / kMetresPerMillimetre, 0.1, 500.0, "mm");
    const auto centre = geometry::locate_in_chart(face, disc->centre);
    violations.absorb("disc.centre", centre.status());
    if (!violations.empty()) return violations.to_status();
    return Membership(
        [&face, at = geometry::skin_position(face.grid, *centre), r = disc->radius](const geometry::ChartPoint& p) {
          return (geometry::skin_position(face.grid, p) - at).norm() <= r;
        });
  }
  if (const auto* painted = std::get_if<PaintedRegion>(&zone.shape)) {
    FieldViolations violations;
    violations.absorb("painted", painted->cover.validate());
    if (!violations.empty()) return violations.to_status();
    return Membership([cover = painted->cover](const geometry::ChartPoint& p) { return cover.at(p.xi, p.eta) >= 0.5; });
  }
  const auto placed = anatomy::place_region(face, std::get<NamedRegion>(zone.shape).name);
  if (!placed.ok()) {
    FieldViolations violations;
    violations.absorb("region", placed.status());
    return violations.to_status();
  }
  return Membership([&face, region = *placed](const geometry::ChartPoint& p) {
    return region.contains(geometry::skin_position(face.grid, p));
  });
}

std::vector<int> assign_zones(const model::FaceModel& model, const FilmSpec& spec, FieldViolations& violations) {
  std::vector<int> zone_of_slot(static_cast<size_t>(spec.n_xi) * spec.n_eta, -1);
  std::set<std::string> names;
  for (size_t z = 0; z < spec.zones.size(); ++z) {
    const std::string field = absl::StrCat("zones[", z, "]");
    if (spec.zones[z].name.empty()) violations.add(field + ".name", "is empty");
    if (!names.insert(spec.zones[z].name).second) {
      violations.add(field + ".name", absl::StrCat("is '", spec.zones[z].name, "' a second time"));
    }
    const auto contains = make_membership(model, spec.zones[z]);
    violations.absorb(field, contains.status());
    if (!contains.ok()) continue;
    int claimed = 0;
    for (int slot = 0; slot < static_cast<int>(zone_of_slot.size()); ++slot) {
      if (zone_of_slot[slot] >= 0 || !(*contains)(slot_centre(spec, slot))) continue;
      zone_of_slot[slot] = static_cast<int>(z);
      ++claimed;
    }
    if (claimed == 0) {
      violations.add(
          field,
          absl::StrCat("'", spec.zones[z].name,
                       "' claims no film cell: it lies outside the film's extent, or other zones hold its cells"));
    }
  }
  return zone_of_slot;
}

}  // namespace

geometry::ChartPoint slot_centre(const FilmSpec& spec, int slot) {
  const int i = slot % spec.n_xi;
  const int j = slot / spec.n_xi;
  return {spec.extent.xi_min + (spec.extent.xi_max - spec.extent.xi_min) * (i + 0.5) / spec.n_xi,
          spec.extent.eta_min + (spec.extent.eta_max - spec.extent.eta_min) * (j + 0.5) / spec.n_eta};
}

int FilmLayout::cell_at(const geometry::ChartPoint& place) const {
  const double x = (place.xi - grid.extent.xi_min) / (grid.extent.xi_max - grid.extent.xi_min) * grid.n_xi;
  const double y = (place.eta - grid.extent.eta_min) / (grid.extent.eta_max - grid.extent.eta_min) * grid.n_eta;
  constexpr double kRoundOff = 1e-9;
  if (x < -kRoundOff || y < -kRoundOff || x > grid.n_xi + kRoundOff || y > grid.n_eta + kRoundOff) return -1;
  const int i = std::clamp(static_cast<int>(x), 0, grid.n_xi - 1);
  const int j = std::clamp(static_cast<int>(y), 0, grid.n_eta - 1);
  return grid.cell_of_slot[j * grid.n_xi + i];
}

geometry::ChartPoint FilmLayout::cell_centre(int cell) const {
  const int slot = grid.slot_of_cell[cell];
  const double i = grid.slot_i(slot) + 0.5;
  const double j = grid.slot_j(slot) + 0.5;
  return {grid.extent.xi_min + (grid.extent.xi_max - grid.extent.xi_min) * i / grid.n_xi,
          grid.extent.eta_min + (grid.extent.eta_max - grid.extent.eta_min) * j / grid.n_eta};
}

absl::StatusOr<FilmLayout> place_film(const model::FaceModel& model, const FilmSpec& spec) {
  FieldViolations violations;
  if (spec.name.empty()) violations.add("name", "is empty");
  check_box(spec.extent, "extent", violations);
  check_grid_counts(spec, violations);
  check_thickness(spec.rest_thickness, "rest_thickness_mm", spec.wall == FilmWallKind::kRigid ? 1e-3 : 0.0, violations);
  if (spec.initial_thickness.has_value())
    check_thickness(*spec.initial_thickness, "initial_thickness_mm", 0.0, violations);
  if (spec.zones.empty()) violations.add("zones", "there are none; at least 1 is needed");
  if (spec.wall == FilmWallKind::kWinkler) {
    violations.check_range("wall.stiffness_kpa_per_mm",
                           spec.wall_stiffness / kPascalsPerMetrePerKilopascalPerMillimetre, 1e-9, 1e9, "kPa/mm");
  }
  check_connective_tissue(spec, violations);
  FilmLayout layout;
  if (spec.wall == FilmWallKind::kTissue) {
    layout.level = find_level(model, spec, violations);
  } else if (!spec.below_layer.empty()) {
    violations.add("below_layer",
                   absl::StrCat("is '", spec.below_layer, "', must be empty when wall is RIGID or WINKLER"));
  }
  if (!violations.empty()) return violations.to_status();
  if (spec.wall == FilmWallKind::kTissue) {
    check_coarseness("n_xi", spec.extent.xi_max - spec.extent.xi_min, spec.n_xi, model.geometry.grid.n_xi, violations);
    check_coarseness("n_eta", spec.extent.eta_max - spec.extent.eta_min, spec.n_eta, model.geometry.grid.n_eta,
                     violations);
  }
  const std::vector<int> zone_of_slot = assign_zones(model, spec, violations);
  if (!violations.empty()) return violations.to_status();

  layout.name = spec.name;
  for (const ZoneSpec& zone : spec.zones) layout.zone_names.push_back(zone.name);
  auto walls = place_walls(model, spec, zone_of_slot);
  if (!walls.ok()) return walls.status();
  layout.walled_slots = walls->inside_zones;
  layout.grid = film::make_film_grid(spec.extent, spec.n_xi, spec.n_eta, zone_of_slot, layout.walled_slots);
  layout.grid.leaky_walls = find_leaky_walls(model.geometry.grid, layout.grid, *walls);
  layout.wall = spec.wall;
  layout.wall_stiffness = spec.wall_stiffness;
  layout.wall_friction = spec.wall_friction;
  layout.rest_thickness = spec.rest_thickness;
  layout.connective_tissue = spec.connective_tissue;
  layout.initial_thickness = spec.initial_thickness.value_or(spec.rest_thickness);
  return layout;
}

Eigen::Matrix3Xd vertices_on_skin(const geometry::LayeredGrid& grid, const film::FilmGrid& film) {
  Eigen::Matrix3Xd vertices(3, film.n_vertices());
  for (int j = 0; j <= film.n_eta; ++j) {
    for (int i = 0; i <= film.n_xi; ++i) {
      vertices.col(film.vertex(i, j)) = geometry::skin_position(grid, {film.vertex_xi(i), film.vertex_eta(j)});
    }
  }
  return vertices;
}

std::vector<bool> find_open_nodes(const geometry::LayeredGrid& tissue, const FilmLayout& layout) {
  const film::FilmGrid& film = layout.grid;
  const ChartBox& box = film.extent;
  constexpr double kRoundOff = 1e-9;
  constexpr int kOutside = -1;
  /// Adds the film's slots that a quadrilateral of the tissue overlaps.
  const auto add_slots_of_quad = [&](int qi, int qj, std::set<int>& slots) {
    const auto to_film = [](double at, double low, double high, int n) { return (at - low) / (high - low) * n; };
    const double x0 = to_film(static_cast<double>(qi) / tissue.n_xi, box.xi_min, box.xi_max, film.n_xi);
    const double x1 = to_film(static_cast<double>(qi + 1) / tissue.n_xi, box.xi_min, box.xi_max, film.n_xi);
    const double y0 = to_film(static_cast<double>(qj) / tissue.n_eta, box.eta_min, box.eta_max, film.n_eta);
    const double y1 = to_film(static_cast<double>(qj + 1) / tissue.n_eta, box.eta_min, box.eta_max, film.n_eta);
    if (x0 < -kRoundOff || y0 < -kRoundOff || x1 > film.n_xi + kRoundOff || y1 > film.n_eta + kRoundOff) {
      slots.insert(kOutside);
      return;
    }
    for (int j = static_cast<int>(y0 + kRoundOff); j < y1 - kRoundOff; ++j) {
      for (int i = static_cast<int>(x0 + kRoundOff); i < x1 - kRoundOff; ++i) slots.insert(j * film.n_xi + i);
    }
  };
  const auto zone_of = [&](int slot) {
    const int cell = slot == kOutside ? -1 : film.cell_of_slot[slot];
    return cell < 0 ? -1 : film.zone_of_cell[cell];
  };
  const auto in_one_piece = [&](const std::set<int>& slots) {
    const int zone = zone_of(*slots.begin());
    if (zone < 0) return false;
    if (!std::all_of(slots.begin(), slots.end(), [&](int slot) { return zone_of(slot) == zone; })) return false;
    return std::none_of(layout.walled_slots.begin(), layout.walled_slots.end(), [&](const std::pair<int, int>& wall) {
      return slots.contains(wall.first) && slots.contains(wall.second);
    });
  };
  std::vector<bool> open(tissue.nodes_per_level());
  for (int j = 0; j <= tissue.n_eta; ++j) {
    for (int i = 0; i <= tissue.n_xi; ++i) {
      std::set<int> slots;
      for (int qj = std::max(j - 1, 0); qj <= std::min(j, tissue.n_eta - 1); ++qj) {
        for (int qi = std::max(i - 1, 0); qi <= std::min(i, tissue.n_xi - 1); ++qi) add_slots_of_quad(qi, qj, slots);
      }
      open[tissue.surface_index(i, j)] = in_one_piece(slots);
    }
  }
  return open;
}

}  // namespace lipofill::plan
