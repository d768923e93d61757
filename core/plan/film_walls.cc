#include "core/plan/film_walls.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/plan/zone_placement.h"

namespace lipofill::plan {
namespace {

using geometry::ChartPoint;

constexpr size_t kMaxPathPoints = 256;

double side_of(const ChartPoint& a, const ChartPoint& b, const ChartPoint& p) {
  return (b.xi - a.xi) * (p.eta - a.eta) - (b.eta - a.eta) * (p.xi - a.xi);
}

/// True when the segments cross. Touching at an end counts for the left side only, so that a path
/// through centres parts each pair once.
bool segments_cross(const ChartPoint& a, const ChartPoint& b, const ChartPoint& c, const ChartPoint& d) {
  return (side_of(a, b, c) >= 0.0) != (side_of(a, b, d) >= 0.0) &&
         (side_of(c, d, a) >= 0.0) != (side_of(c, d, b) >= 0.0);
}

bool path_crosses(const std::vector<ChartPoint>& path, const ChartPoint& from, const ChartPoint& to) {
  for (size_t k = 0; k + 1 < path.size(); ++k) {
    if (segments_cross(path[k], path[k + 1], from, to)) return true;
  }
  return false;
}

std::optional<std::vector<ChartPoint>> locate_path(const model::FaceModel& model, const WallSpec& wall,
                                                   const std::string& field, FieldViolations& violations) {
  if (wall.path.size() < 2 || wall.path.size() > kMaxPathPoints) {
    violations.add(field + ".path.points", absl::StrCat("are ", wall.path.size(), ", must be 2 to ", kMaxPathPoints));
    return std::nullopt;
  }
  std::vector<ChartPoint> path;
  for (size_t k = 0; k < wall.path.size(); ++k) {
    const auto point = geometry::locate_in_chart(model.geometry, wall.path[k]);
    violations.absorb(absl::StrCat(field, ".path.points[", k, "]"), point.status());
    if (point.ok()) path.push_back(*point);
  }
  if (path.size() < wall.path.size()) return std::nullopt;
  return path;
}

/// Index of a zone of the film, -1 with a violation.
int find_zone(const FilmSpec& spec, const std::string& name, const std::string& field, FieldViolations& violations) {
  const auto zone = std::find_if(spec.zones.begin(), spec.zones.end(), [&](const auto& z) { return z.name == name; });
  if (zone != spec.zones.end()) return static_cast<int>(zone - spec.zones.begin());
  violations.add(field, absl::StrCat("is '", name, "', which is no zone of the film"));
  return -1;
}

/// Visits every two neighbouring slots that both have a cell.
void for_each_pair(const FilmSpec& spec, const std::vector<int>& zone_of_slot,
                   const std::function<void(int slot, int next)>& visit) {
  for (int slot = 0; slot < static_cast<int>(zone_of_slot.size()); ++slot) {
    if (zone_of_slot[slot] < 0) continue;
    const bool has_right = slot % spec.n_xi + 1 < spec.n_xi;
    const bool has_upper = slot + spec.n_xi < static_cast<int>(zone_of_slot.size());
    if (has_right && zone_of_slot[slot + 1] >= 0) visit(slot, slot + 1);
    if (has_upper && zone_of_slot[slot + spec.n_xi] >= 0) visit(slot, slot + spec.n_xi);
  }
}

/// The test of whether a wall parts two slots; none where the wall is wrong.
std::function<bool(int, int)> make_test(const model::FaceModel& model, const FilmSpec& spec, const WallSpec& wall,
                                        const std::vector<int>& zone_of_slot, const std::string& field,
                                        FieldViolations& violations) {
  if (wall.path.empty() && !wall.between[0].empty()) {
    const int a = find_zone(spec, wall.between[0], field + ".between.first", violations);
    const int b = find_zone(spec, wall.between[1], field + ".between.second", violations);
    if (a < 0 || b < 0) return nullptr;
    if (a == b) violations.add(field + ".between.second", "is the first zone again");
    return [&zone_of_slot, a, b](int slot, int next) {
      return std::minmax(zone_of_slot[slot], zone_of_slot[next]) == std::minmax(a, b);
    };
  }
  const auto path = locate_path(model, wall, field, violations);
  if (!path) return nullptr;
  return [path = *path, &spec, &zone_of_slot](int slot, int next) {
    return zone_of_slot[slot] == zone_of_slot[next] &&
           path_crosses(path, slot_centre(spec, slot), slot_centre(spec, next));
  };
}

}  // namespace

absl::StatusOr<PlacedWalls> place_walls(const model::FaceModel& model, const FilmSpec& spec,
                                        const std::vector<int>& zone_of_slot) {
  FieldViolations violations;
  PlacedWalls placed;
  for (size_t w = 0; w < spec.walls.size(); ++w) {
    const WallSpec& wall = spec.walls[w];
    const std::string field = absl::StrCat("walls[", w, "]");
    violations.check_range(field + ".leakage_ml_per_s_kpa_cm", wall.leakage / kLeakageUnit, 0.0, 1e6, "mL/(s kPa cm)");
    const auto parts = make_test(model, spec, wall, zone_of_slot, field, violations);
    if (!parts) continue;
    int found = 0;
    for_each_pair(spec, zone_of_slot, [&](int slot, int next) {
      if (!parts(slot, next)) return;
      ++found;
      if (zone_of_slot[slot] == zone_of_slot[next]) placed.inside_zones.insert({slot, next});
      if (wall.leakage > 0.0) placed.leaky.push_back({{slot, next}, wall.leakage});
    });
    if (found == 0)
      violations.add(field, "parts no two cells of the film: it lies outside its zones, or between centres");
  }
  if (!violations.empty()) return violations.to_status();
  return placed;
}

std::vector<film::LeakyWall> find_leaky_walls(const geometry::LayeredGrid& tissue, const film::FilmGrid& film,
                                              const PlacedWalls& walls) {
  const auto vertex = [&](int i, int j) {
    return geometry::skin_position(tissue, {film.vertex_xi(i), film.vertex_eta(j)});
  };
  std::vector<film::LeakyWall> leaky;
  for (const auto& [slots, leakage] : walls.leaky) {
    const int i = film.slot_i(slots.second);
    const int j = film.slot_j(slots.second);
    const bool along_xi = slots.second == slots.first + 1;
    const double length =
        along_xi ? (vertex(i, j + 1) - vertex(i, j)).norm() : (vertex(i + 1, j) - vertex(i, j)).norm();
    leaky.push_back({film.cell_of_slot[slots.first], film.cell_of_slot[slots.second], leakage * length});
  }
  return leaky;
}

}  // namespace lipofill::plan
