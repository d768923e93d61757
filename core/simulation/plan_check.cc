#include "core/simulation/plan_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/film/film_metric.h"
#include "core/mechanics/tissue_setup.h"
#include "core/mechanics/wall_fibres.h"
#include "core/plan/plan_placement.h"
#include "core/simulation/frame_layout.h"

namespace lipofill::simulation {
namespace {

/// Numbers the zones of all films of a plan, placed or not.
std::vector<int> count_zones_before(const plan::SimulationSpec& spec) {
  std::vector<int> before = {0};
  for (const plan::FilmSpec& film : spec.films) before.push_back(before.back() + static_cast<int>(film.zones.size()));
  return before;
}

std::vector<Eigen::Matrix3Xd> place_outline(const geometry::LayeredGrid& grid,
                                            const std::vector<geometry::OutlineLoop>& outline) {
  std::vector<Eigen::Matrix3Xd> lines;
  for (const geometry::OutlineLoop& loop : outline) {
    Eigen::Matrix3Xd& line = lines.emplace_back(3, static_cast<Eigen::Index>(loop.size()));
    for (Eigen::Index k = 0; k < line.cols(); ++k) {
      line.col(k) = geometry::skin_position(grid, loop[static_cast<size_t>(k)]);
    }
  }
  return lines;
}

void add_zones(const model::FaceModel& model, const plan::FilmLayout& film, int zones_before,
               std::vector<PlacedZone>& zones) {
  const Eigen::Matrix3Xd vertices = plan::vertices_on_skin(model.geometry.grid, film.grid);
  const Eigen::VectorXd areas = film::compute_film_metric(film.grid, vertices).area;
  const auto first = zones.size();
  for (int z = 0; z < static_cast<int>(film.zone_names.size()); ++z) {
    zones.push_back({zones_before + z + 1, film.name, film.zone_names[static_cast<size_t>(z)], 0, 0.0,
                     place_outline(model.geometry.grid, film.drawn[static_cast<size_t>(z)])});
  }
  for (int cell = 0; cell < film.grid.n_cells(); ++cell) {
    PlacedZone& zone = zones[first + static_cast<size_t>(film.grid.zone_of_cell[cell])];
    ++zone.n_cells;
    zone.area += areas[cell];
  }
}

std::vector<int> find_zones_under_skin(const model::FaceModel& model, const plan::PlacedPlan& placed,
                                       const std::vector<int>& zones_before) {
  const geometry::LayeredGrid& grid = model.geometry.grid;
  std::vector<int> numbers(static_cast<size_t>(grid.nodes_per_level()));
  for (const SkinPoint& point : make_frame_layout(grid, placed.films, model.geometry).skin) {
    if (point.film < 0) continue;
    const auto film = static_cast<size_t>(point.film);
    if (placed.films[film].is_feather[point.cell]) continue;
    const int zone = placed.films[film].grid.zone_of_cell[point.cell];
    numbers[static_cast<size_t>(point.vertex)] =
        zones_before[static_cast<size_t>(placed.spec_of_film[film])] + zone + 1;
  }
  return numbers;
}

/// Tells whether the tissue can open a cell: a node of a quadrilateral that overlaps it is doubled,
/// and one copy is free.
bool can_open(const geometry::LayeredGrid& tissue, const mechanics::HeldMesh& held, const coupling::WallNodes& walls,
              const film::FilmGrid& film, int cell) {
  constexpr double kRoundOff = 1e-9;
  const int slot = film.slot_of_cell[cell];
  const int i = film.slot_i(slot);
  const int j = film.slot_j(slot);
  const auto first = [](double at, int n) { return static_cast<int>(at * n + kRoundOff); };
  const auto last = [](double at, int n) { return static_cast<int>(std::ceil(at * n - kRoundOff)); };
  for (int b = first(film.vertex_eta(j), tissue.n_eta); b <= last(film.vertex_eta(j + 1), tissue.n_eta); ++b) {
    for (int a = first(film.vertex_xi(i), tissue.n_xi); a <= last(film.vertex_xi(i + 1), tissue.n_xi); ++a) {
      const auto place = static_cast<size_t>(tissue.surface_index(a, b));
      const auto is_held = [&](int node) {
        const auto& fixed = held.supports.fixed[static_cast<size_t>(node)];
        return std::all_of(fixed.begin(), fixed.end(), [](bool axis) { return axis; });
      };
      if (walls.outer[place] == walls.inner[place]) continue;
      if (!is_held(walls.outer[place]) || !is_held(walls.inner[place])) return true;
    }
  }
  return false;
}

void check_cells_can_open(const model::FaceModel& model, const plan::FilmLayout& film, const std::string& field,
                          const mechanics::HeldMesh& held, const coupling::WallNodes& walls,
                          FieldViolations& violations) {
  std::vector<bool> told(film.zone_names.size());
  for (int cell = 0; cell < film.grid.n_cells(); ++cell) {
    const auto zone = static_cast<size_t>(film.grid.zone_of_cell[cell]);
    if (told[zone] || can_open(model.geometry.grid, held, walls, film.grid, cell)) continue;
    told[zone] = true;
    const geometry::ChartPoint at = film.cell_centre(cell);
    violations.add(absl::StrCat(field, ".zones[", zone, "]"),
                   absl::StrCat("has a film cell at (", at.xi, ", ", at.eta,
                                ") of the chart where no node of the tissue is free: make the zone at least two cells "
                                "wide"));
  }
}

/// Checks what joins films and tissue, once all films are placed.
void check_tissue(const model::FaceModel& model, const plan::SimulationSpec& spec, const plan::PlacedPlan& placed,
                  FieldViolations& violations) {
  const mechanics::HeldMesh held = mechanics::hold_mesh(model, placed.films);
  std::vector<mechanics::FilmOnTissue> on_tissue;
  for (size_t f = 0; f < placed.films.size(); ++f) {
    const plan::FilmLayout& film = placed.films[f];
    if (film.wall != plan::FilmWallKind::kTissue) continue;
    const coupling::WallNodes& walls = held.walls[on_tissue.size()];
    on_tissue.push_back({&film, &walls});
    check_cells_can_open(model, film, absl::StrCat("films[", f, "]"), held, walls, violations);
  }
  violations.absorb("", mechanics::place_wall_fibres(model, on_tissue, spec.ligaments, held.split.mesh).status());
}

bool has_inner_cell(const film::FilmGrid& grid, int zone) {
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const auto& sides = grid.edge_of_side[cell];
    if (grid.zone_of_cell[cell] == zone && *std::min_element(sides.begin(), sides.end()) >= 0) return true;
  }
  return false;
}

void remark_on_zones(const plan::PlacedPlan& placed, FieldViolations& remarks) {
  for (size_t f = 0; f < placed.films.size(); ++f) {
    const plan::FilmLayout& film = placed.films[f];
    if (film.wall != plan::FilmWallKind::kTissue) continue;
    for (size_t z = 0; z < film.zone_names.size(); ++z) {
      if (has_inner_cell(film.grid, static_cast<int>(z))) continue;
      remarks.add(absl::StrCat("films[", placed.spec_of_film[f], "].zones[", z, "]"),
                  absl::StrCat("'", film.zone_names[z],
                               "' has no film cell away from its edge, where the tissue is bonded: make it wider, or "
                               "the cells smaller"));
    }
  }
}

void remark_on_injections(const plan::SimulationSpec& spec, const plan::PlacedPlan& placed, FieldViolations& remarks) {
  if (spec.injections.empty()) remarks.add("injections", "there are none: nothing will move");
  if (placed.schedule.end() > spec.end) {
    remarks.add("time.end_s", absl::StrCat("is ", spec.end, " s, before the injections end at ", placed.schedule.end(),
                                           " s: what is left of them will not be injected"));
  }
}

}  // namespace

absl::StatusOr<PlanCheck> check_plan_on_model(const model::FaceModel& model, const plan::SimulationSpec& spec,
                                              const Unwanted& unwanted) {
  plan::PlacedPlan placed;
  const absl::Status placement = plan::place_plan(model, spec, unwanted, placed);
  if (absl::IsCancelled(placement)) return placement;
  FieldViolations violations;
  violations.absorb("", placement);
  const bool all_are_placed = placed.films.size() == spec.films.size();
  if (all_are_placed && !model.layers.empty()) check_tissue(model, spec, placed, violations);
  if (const absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
  FieldViolations remarks;
  remark_on_zones(placed, remarks);
  if (violations.empty()) remark_on_injections(spec, placed, remarks);
  PlanCheck check;
  check.violations = violations.all();
  check.remarks = remarks.all();
  const std::vector<int> zones_before = count_zones_before(spec);
  for (size_t f = 0; f < placed.films.size(); ++f) {
    add_zones(model, placed.films[f], zones_before[static_cast<size_t>(placed.spec_of_film[f])], check.zones);
  }
  check.zone_under_skin = find_zones_under_skin(model, placed, zones_before);
  return check;
}

}  // namespace lipofill::simulation
