#include "core/plan/film_layout.h"

#include <algorithm>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/geometry/node_values.h"
#include "core/plan/film_walls.h"
#include "core/plan/zone_attachment.h"
#include "core/plan/zone_levels.h"
#include "core/plan/zone_outline.h"
#include "core/plan/zone_placement.h"

namespace lipofill::plan {
namespace {

constexpr int kMaxFilmCells = 65536;
/// A cell that nobody chose is so many hexahedra wide.
constexpr int kHexahedraAcrossCell = 2;
constexpr double kCoarsestRatio = 2.0;
constexpr double kThickest_mm = 50.0;
/// Less of a film over a base that gives is not worth a remark.
constexpr double kLeastSoftShare = 0.01;

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

void check_edge(const FilmSpec& spec, FieldViolations& violations) {
  if (!spec.edge.attachment.has_value()) return;
  const AttachmentSpec& attachment = *spec.edge.attachment;
  violations.check_range("edge.attachment.stiffness_kpa_per_mm",
                         attachment.stiffness / kPascalsPerMetrePerKilopascalPerMillimetre, 1e-3, 1e6, "kPa/mm");
  violations.check_range("edge.attachment.width_mm", attachment.width / kMetresPerMillimetre, 0.1, 50.0, "mm");
  if (spec.edge.is_rigid) violations.add("edge.rigid", "is true beside an attachment: give one of them");
  if (spec.wall != FilmWallKind::kTissue)
    violations.add("edge.attachment", "is given, but only films on tissue have walls to attach");
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

/// Says what holds the layers together around zones whose plan does not.
void remark_on_attachments(const model::FaceModel& model, const FilmSpec& spec, std::vector<std::string>& remarks) {
  if (has_rigid_edge(model, spec.edge) || spec.edge.attachment.has_value()) return;
  for (const ZoneSpec& zone : spec.zones) {
    const AttachmentSpec assumed = assume_attachment(zone);
    remarks.push_back(absl::StrCat("Around zone ", zone.name, " the layers are assumed to hold together with ",
                                   assumed.stiffness / kPascalsPerMetrePerKilopascalPerMillimetre,
                                   " kPa/mm, which grows over ", assumed.width / kMetresPerMillimetre, " mm",
                                   assumed.feathers ? "; fat feathers out there." : "."));
  }
}

/// Says how much of a film on the base has soft tissue beneath it on the patient, and bone in the
/// model.
void remark_on_soft_base(const model::FaceModel& model, FilmLayout& layout) {
  const geometry::LayeredGrid& grid = model.geometry.grid;
  if (layout.level != grid.n_levels() - 1) return;
  double soft = model.base.kind == model::SupportKind::kElastic ? 1.0 : 0.0;
  if (model.base.kind == model::SupportKind::kByRegion) {
    const geometry::ScalarField give = geometry::field_of_nodes(model.base_give, grid);
    double covered = 0.0;
    for (int cell = 0; cell < layout.grid.n_cells(); ++cell) {
      const geometry::ChartPoint centre = layout.cell_centre(cell);
      const film::SlotCover& cover = layout.grid.cover[cell];
      const double share = std::accumulate(cover.begin(), cover.end(), 0.0);
      covered += share;
      soft += share * static_cast<double>(give.at(centre.xi, centre.eta) > model::kLeastGive);
    }
    soft /= covered;
  }
  if (soft < kLeastSoftShare) return;
  layout.remarks.push_back(absl::StrFormat(
      "Film %s lies on the base, which gives under %.0f %% of it; a film on the base has bone beneath it in the model, "
      "so that all its fat pushes outwards: put it below a layer further out where there is no bone.",
      layout.name, 100.0 * soft));
}

/// A cell is beyond the outline when its centre is; a zone smaller than a cell has the cell whose
/// centre is nearest.
void find_feather_cells(const PlacedZones& zones, FilmLayout& layout) {
  layout.is_feather.assign(layout.grid.n_cells(), false);
  if (zones.distances.empty()) return;
  std::vector<int> innermost(zones.drawn.size(), -1);
  std::vector<double> depth(static_cast<size_t>(layout.grid.n_cells()));
  for (int cell = 0; cell < layout.grid.n_cells(); ++cell) {
    const auto zone = static_cast<size_t>(layout.grid.zone_of_cell[cell]);
    const geometry::ChartPoint centre = layout.cell_centre(cell);
    depth[cell] = zones.distances[zone].at(centre.xi, centre.eta);
    layout.is_feather[cell] = depth[cell] < 0.0;
    if (innermost[zone] < 0 || depth[cell] > depth[innermost[zone]]) innermost[zone] = cell;
  }
  for (const int cell : innermost) layout.is_feather[cell] = false;
}

/// The edges of whole cells as lines of the chart.
std::vector<geometry::OutlineLoop> outline_of_cells(const film::FilmGrid& grid, int zone) {
  std::vector<geometry::OutlineLoop> outline;
  for (const OutlineLoop& loop : trace_zone_outline(grid, zone)) {
    geometry::OutlineLoop& line = outline.emplace_back();
    for (const int vertex : loop) {
      line.push_back({grid.vertex_xi(vertex % (grid.n_xi + 1)), grid.vertex_eta(vertex / (grid.n_xi + 1))});
    }
  }
  return outline;
}

}  // namespace

int FilmLayout::slot_at(const geometry::ChartPoint& place) const {
  const double x = (place.xi - grid.extent.xi_min) / (grid.extent.xi_max - grid.extent.xi_min) * grid.n_xi;
  const double y = (place.eta - grid.extent.eta_min) / (grid.extent.eta_max - grid.extent.eta_min) * grid.n_eta;
  constexpr double kRoundOff = 1e-9;
  if (x < -kRoundOff || y < -kRoundOff || x > grid.n_xi + kRoundOff || y > grid.n_eta + kRoundOff) return -1;
  const int i = std::clamp(static_cast<int>(x), 0, grid.n_xi - 1);
  const int j = std::clamp(static_cast<int>(y), 0, grid.n_eta - 1);
  return j * grid.n_xi + i;
}

int FilmLayout::cell_at(const geometry::ChartPoint& place) const {
  const int slot = slot_at(place);
  return slot < 0 ? -1 : grid.cell_of_slot[slot];
}

geometry::ChartPoint FilmLayout::cell_centre(int cell) const {
  const int slot = grid.slot_of_cell[cell];
  const double i = grid.slot_i(slot) + 0.5;
  const double j = grid.slot_j(slot) + 0.5;
  return {grid.extent.xi_min + (grid.extent.xi_max - grid.extent.xi_min) * i / grid.n_xi,
          grid.extent.eta_min + (grid.extent.eta_max - grid.extent.eta_min) * j / grid.n_eta};
}

FilmSpec with_cells(FilmSpec spec, const geometry::LayeredGrid& tissue) {
  const auto cells_over = [](double span, int n) {
    if (!(span > 0.0)) return 1;
    return std::max(1, static_cast<int>(std::floor(std::min(span, 1.0) * n / kHexahedraAcrossCell + 1e-9)));
  };
  if (spec.n_xi == 0) spec.n_xi = cells_over(spec.extent.xi_max - spec.extent.xi_min, tissue.n_xi);
  if (spec.n_eta == 0) spec.n_eta = cells_over(spec.extent.eta_max - spec.extent.eta_min, tissue.n_eta);
  return spec;
}

absl::StatusOr<FilmLayout> place_film(const model::FaceModel& model, const FilmSpec& given) {
  const FilmSpec spec = with_cells(given, model.geometry.grid);
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
  check_edge(spec, violations);
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
  const PlacedZones zones = place_zones(model, spec, violations, layout.remarks);
  if (!violations.empty()) return violations.to_status();

  layout.name = spec.name;
  for (const ZoneSpec& zone : spec.zones) layout.zone_names.push_back(zone.name);
  auto walls = place_walls(model, spec, zones.zone_of_slot);
  if (!walls.ok()) return walls.status();
  layout.walled_slots = walls->inside_zones;
  layout.grid = film::make_film_grid(spec.extent, spec.n_xi, spec.n_eta, zones.zone_of_slot, layout.walled_slots,
                                     zones.cover, zones.fragments);
  layout.grid.leaky_walls = find_leaky_walls(model.geometry.grid, layout.grid, *walls);
  if (spec.wall == FilmWallKind::kTissue) {
    const geometry::LayeredGrid& tissue = model.geometry.grid;
    layout.pieces = film::cut_cells(layout.grid, tissue.n_xi, tissue.n_eta);
    if (spec.edge.outline == ZoneOutline::kCurve) layout.pieces = cut_at_outlines(layout.pieces, layout.grid, zones);
    remark_on_attachments(model, spec, layout.remarks);
    layout.bond = bond_around_zones(model, spec, layout.level, layout.grid, layout.pieces, layout.walled_slots, zones);
  }
  for (size_t z = 0; z < spec.zones.size(); ++z) {
    const bool as_drawn = spec.edge.outline == ZoneOutline::kCurve;
    layout.outlines.push_back(as_drawn ? zones.outlines[z] : outline_of_cells(layout.grid, static_cast<int>(z)));
    const bool stays_inside = zones.distances.empty();
    layout.drawn.push_back(stays_inside ? layout.outlines.back() : zones.drawn[z].outline);
  }
  find_feather_cells(zones, layout);
  layout.wall = spec.wall;
  layout.wall_stiffness = spec.wall_stiffness;
  layout.wall_friction = spec.wall_friction;
  layout.rest_thickness = spec.rest_thickness;
  layout.connective_tissue = spec.connective_tissue;
  layout.initial_thickness = spec.initial_thickness.value_or(spec.rest_thickness);
  if (spec.wall == FilmWallKind::kTissue) remark_on_soft_base(model, layout);
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

}  // namespace lipofill::plan
