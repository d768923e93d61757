#include "core/mechanics/wall_fibres.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "absl/strings/str_cat.h"
#include "core/anatomy/ligaments.h"
#include "core/base/field_violations.h"

namespace lipofill::mechanics {
namespace {

constexpr double kNewtonPerMetreInNewtonPerMillimetre = 1e3;
constexpr double kMillimetrePerMetre = 1e3;
constexpr size_t kMaxLigaments = 64;
constexpr size_t kMaxLigamentPoints = 256;

/// The quadrilateral of a level around a place, and its bilinear weights.
struct Around {
  std::array<int, 4> places;
  std::array<double, 4> weights;
};

Around look_around(const geometry::LayeredGrid& grid, const geometry::ChartPoint& at) {
  const double x = at.xi * grid.n_xi;
  const double y = at.eta * grid.n_eta;
  const int i = std::clamp(static_cast<int>(x), 0, grid.n_xi - 1);
  const int j = std::clamp(static_cast<int>(y), 0, grid.n_eta - 1);
  const double s = x - i;
  const double t = y - j;
  return {{grid.surface_index(i, j), grid.surface_index(i + 1, j), grid.surface_index(i + 1, j + 1),
           grid.surface_index(i, j + 1)},
          {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t}};
}

/// Index of the film of a name among those on tissue, -1 with a violation.
int find_film(const std::vector<FilmOnTissue>& films, const std::string& name, const std::string& field,
              FieldViolations& violations) {
  const auto found =
      std::find_if(films.begin(), films.end(), [&](const FilmOnTissue& f) { return f.film->name == name; });
  if (found != films.end()) return static_cast<int>(found - films.begin());
  violations.add(field, absl::StrCat("is '", name, "', which is no film on tissue of the plan"));
  return -1;
}

class LigamentPlacer {
 public:
  LigamentPlacer(const model::FaceModel& model, const std::vector<FilmOnTissue>& films, WallFibres& fibres)
      : model_(model), films_(films), fibres_(fibres) {}

  void place(const plan::LigamentSpec& spec, const std::string& field, FieldViolations& violations) {
    if (films_.empty()) {
      violations.add(field, "needs a film on tissue; the plan has none");
      return;
    }
    const int outer = spec.film.empty() ? 0 : find_film(films_, spec.film, field + ".film", violations);
    const int inner =
        spec.inner_film.empty() ? outer : find_film(films_, spec.inner_film, field + ".inner_film", violations);
    if (outer < 0 || inner < 0) return;
    if (films_[inner].film->level < films_[outer].film->level) {
      violations.add(field + ".inner_film", absl::StrCat("is '", spec.inner_film, "', which lies outside '",
                                                         films_[outer].film->name, "': name the outer film first"));
      return;
    }
    anatomy::LigamentFigures figures{0.0, std::numeric_limits<double>::infinity()};
    const std::vector<geometry::ChartPoint> points = find_points(spec, field, figures, violations);
    if (points.empty()) return;
    if (spec.stiffness.has_value()) figures.stiffness = *spec.stiffness;
    if (spec.breaking_force.has_value()) figures.breaking_force = *spec.breaking_force;
    check_figures(spec, figures, field, violations);
    LigamentLayout layout{spec.name, static_cast<int>(fibres_.springs.size()), 0, figures.breaking_force};
    for (size_t k = 0; k < points.size(); ++k) {
      if (add_spring(points[k], outer, inner, figures.stiffness, spec.slack)) {
        ++layout.n_springs;
      } else if (std::holds_alternative<std::vector<geometry::SkinPoint>>(spec.place)) {
        violations.add(absl::StrCat(field, ".points.points[", k, "]"),
                       absl::StrCat("lies at (", points[k].xi, ", ", points[k].eta,
                                    ") of the chart, where no zone of the film parts the tissue"));
      }
    }
    if (layout.n_springs == 0 && std::holds_alternative<plan::NamedLigament>(spec.place)) {
      violations.add(field, absl::StrCat("'", spec.name, "' reaches no zone of the film"));
    }
    fibres_.ligaments.push_back(std::move(layout));
  }

 private:
  std::vector<geometry::ChartPoint> find_points(const plan::LigamentSpec& spec, const std::string& field,
                                                anatomy::LigamentFigures& figures, FieldViolations& violations) const {
    if (const auto* named = std::get_if<plan::NamedLigament>(&spec.place)) {
      const auto placed = anatomy::place_ligament(model_.geometry, named->name);
      violations.absorb(field + ".anatomical", placed.status());
      if (!placed.ok()) return {};
      figures = placed->figures;
      return placed->points;
    }
    const auto& points = std::get<std::vector<geometry::SkinPoint>>(spec.place);
    if (points.empty() || points.size() > kMaxLigamentPoints) {
      violations.add(field + ".points.points",
                     absl::StrCat("are ", points.size(), ", must be 1 to ", kMaxLigamentPoints));
      return {};
    }
    std::vector<geometry::ChartPoint> located;
    for (size_t k = 0; k < points.size(); ++k) {
      const auto point = geometry::locate_in_chart(model_.geometry, points[k]);
      violations.absorb(absl::StrCat(field, ".points.points[", k, "]"), point.status());
      if (point.ok()) located.push_back(*point);
    }
    return located;
  }

  static void check_figures(const plan::LigamentSpec& spec, const anatomy::LigamentFigures& figures,
                            const std::string& field, FieldViolations& violations) {
    violations.check_range(field + ".stiffness_n_per_mm", figures.stiffness / kNewtonPerMetreInNewtonPerMillimetre,
                           1e-9, 1e6, "N/mm");
    violations.check_range(field + ".slack_mm", spec.slack * kMillimetrePerMetre, 0.0, 100.0, "mm");
    if (spec.breaking_force.has_value()) {
      violations.check_range(field + ".breaking_force_n", *spec.breaking_force, 1e-9, 1e6, "N");
    }
  }

  /// False where the tissue is in one piece.
  bool add_spring(const geometry::ChartPoint& at, int outer, int inner, double stiffness, double slack) {
    const Around around = look_around(model_.geometry.grid, at);
    solid::WallSpring spring{{}, {}, around.weights, stiffness, slack};
    bool parted = false;
    for (int c = 0; c < 4; ++c) {
      spring.outer[c] = films_[outer].nodes->outer[around.places[c]];
      spring.inner[c] = films_[inner].nodes->inner[around.places[c]];
      parted = parted || (around.weights[c] > 0.0 && spring.outer[c] != spring.inner[c]);
    }
    if (parted) fibres_.springs.push_back(spring);
    return parted;
  }

  const model::FaceModel& model_;
  const std::vector<FilmOnTissue>& films_;
  WallFibres& fibres_;
};

/// Share of a level's area that belongs to each of its nodes [m2].
std::vector<double> share_area(const geometry::LayeredGrid& grid, const coupling::WallNodes& walls,
                               const solid::HexMesh& mesh) {
  std::vector<double> area(grid.nodes_per_level(), 0.0);
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) {
      const std::array<int, 4> places = {grid.surface_index(i, j), grid.surface_index(i + 1, j),
                                         grid.surface_index(i + 1, j + 1), grid.surface_index(i, j + 1)};
      const auto x = [&](int c) { return mesh.rest_positions.col(walls.outer[places[c]]); };
      const double quad = 0.5 * Eigen::Vector3d(x(2) - x(0)).cross(Eigen::Vector3d(x(3) - x(1))).norm();
      for (const int place : places) area[place] += 0.25 * quad;
    }
  }
  return area;
}

/// Connective tissue and the attachment at the edge of zones: both hold the two copies of an open
/// node together.
void add_fibres_of_nodes(const model::FaceModel& model, const FilmOnTissue& film, const solid::HexMesh& mesh,
                         WallFibres& fibres) {
  const double stiffness = film.film->connective_tissue.stiffness;
  const std::vector<bool>& open = film.film->bond.open;
  const std::vector<double> area = share_area(model.geometry.grid, *film.nodes, mesh);
  for (size_t place = 0; place < open.size(); ++place) {
    const int outer = film.nodes->outer[place];
    const int inner = film.nodes->inner[place];
    const double of_node = stiffness * area[place] + film.film->bond.stiffness[place];
    if (!open[place] || outer == inner || of_node <= 0.0) continue;
    fibres.springs.push_back(
        {{outer, outer, outer, outer}, {inner, inner, inner, inner}, {1.0, 0.0, 0.0, 0.0}, of_node, 0.0});
  }
}

}  // namespace

absl::StatusOr<WallFibres> place_wall_fibres(const model::FaceModel& model, const std::vector<FilmOnTissue>& films,
                                             const std::vector<plan::LigamentSpec>& ligaments,
                                             const solid::HexMesh& mesh) {
  FieldViolations violations;
  WallFibres fibres;
  if (ligaments.size() > kMaxLigaments) {
    violations.add("ligaments", absl::StrCat("are ", ligaments.size(), ", must be at most ", kMaxLigaments));
    return violations.to_status();
  }
  LigamentPlacer placer(model, films, fibres);
  std::set<std::string> names;
  for (size_t k = 0; k < ligaments.size(); ++k) {
    const std::string field = absl::StrCat("ligaments[", k, "]");
    if (ligaments[k].name.empty()) violations.add(field + ".name", "is empty");
    if (!names.insert(ligaments[k].name).second) {
      violations.add(field + ".name", absl::StrCat("is '", ligaments[k].name, "' a second time"));
    }
    placer.place(ligaments[k], field, violations);
  }
  if (!violations.empty()) return violations.to_status();
  for (const FilmOnTissue& film : films) add_fibres_of_nodes(model, film, mesh, fibres);
  return fibres;
}

}  // namespace lipofill::mechanics
