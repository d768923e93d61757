#include <algorithm>
#include <utility>

#include "core/base/units.h"
#include "core/film/edge_operators.h"
#include "core/simulation/simulation_impl.h"

namespace lipofill::simulation {
namespace {

template <typename Array>
std::vector<float> to_floats(const Array& numbers, double scale) {
  std::vector<float> values(static_cast<size_t>(numbers.size()));
  std::transform(numbers.data(), numbers.data() + numbers.size(), values.begin(),
                 [scale](double v) { return static_cast<float>(v * scale); });
  return values;
}

bool wanted(const std::vector<std::string>& meshes, const std::string& name) {
  return meshes.empty() || std::find(meshes.begin(), meshes.end(), name) != meshes.end();
}

/// Displacement of `n` vertices [mm], 0 where no point moves them.
/// @param skin  displacement of its nodes [m] (3, n_nodes)
std::vector<float> move(const std::vector<SkinPoint>& points, int n, const Eigen::Matrix3Xd& skin) {
  std::vector<float> values(3 * static_cast<size_t>(n));
  for (const SkinPoint& point : points) {
    float* to = values.data() + 3 * static_cast<ptrdiff_t>(point.vertex);
    for (int c = 0; c < 3; ++c) {
      double sum = 0.0;
      for (int k = 0; k < 4; ++k) sum += point.weights[k] * skin(c, point.nodes[k]);
      to[c] = static_cast<float>(kMillimetresPerMetre * sum);
    }
  }
  return values;
}

/// Values of the cells below `n` vertices, 0 where there is none.
std::vector<float> look_below(const std::vector<SkinPoint>& points, int n, double scale,
                              const std::vector<const Eigen::VectorXd*>& of_films) {
  std::vector<float> values(static_cast<size_t>(n));
  for (const SkinPoint& point : points) {
    if (point.film >= 0) values[point.vertex] = static_cast<float>(scale * (*of_films[point.film])[point.cell]);
  }
  return values;
}

std::vector<double> select_columns(const Eigen::Matrix3Xd& all, const std::vector<int>& columns) {
  return geometry::to_points_mm(Eigen::Matrix3Xd(all(Eigen::all, columns)));
}

std::vector<float> select_moved(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to,
                                const std::vector<int>& columns) {
  std::vector<float> values;
  values.reserve(3 * columns.size());
  for (const int k : columns) {
    for (int c = 0; c < 3; ++c) values.push_back(static_cast<float>(kMillimetresPerMetre * (to(c, k) - from(c, k))));
  }
  return values;
}

}  // namespace

/// The films as a frame shows them.
struct Simulation::Impl::FilmsNow {
  std::vector<film::FilmMetric> metric;
  std::vector<Eigen::VectorXd> thickness;  ///< [m] (n_cells)
  std::vector<Eigen::VectorXd> zone;       ///< each cell has one, counted from 1 through the films in order
  std::vector<const Eigen::VectorXd*> pressures, thicknesses, zones;  ///< each film has one
};

Simulation::Impl::FilmsNow Simulation::Impl::measure_films() const {
  FilmsNow now;
  for (size_t f = 0; f < films.size(); ++f) {
    now.metric.push_back(stepper->geometry().metric_at(f, state.positions));
    now.thickness.emplace_back(state.films[f].volume.cwiseQuotient(now.metric[f].area));
  }
  int zones_before = 0;
  for (const plan::FilmLayout& film : films) {
    const std::vector<int>& of_cell = film.grid.zone_of_cell;
    Eigen::VectorXd& zone = now.zone.emplace_back(static_cast<Eigen::Index>(of_cell.size()));
    for (Eigen::Index cell = 0; cell < zone.size(); ++cell) {
      zone[cell] = 1 + zones_before + of_cell[static_cast<size_t>(cell)];
    }
    zones_before += static_cast<int>(film.zone_names.size());
  }
  for (size_t f = 0; f < films.size(); ++f) {
    now.pressures.push_back(&state.films[f].pressure);
    now.thicknesses.push_back(&now.thickness[f]);
    now.zones.push_back(&now.zone[f]);
  }
  return now;
}

std::vector<MeshTopology> Simulation::topology() const {
  const Impl& impl = *impl_;
  const geometry::FaceGeometry& face = impl.model->geometry;
  std::vector<MeshTopology> meshes = {geometry::make_skin_mesh(face.grid)};
  if (face.scan.n_vertices() > 0) meshes.push_back(geometry::make_scan_mesh(face.scan));
  for (size_t f = 0; f < impl.films.size(); ++f) {
    meshes.push_back({"film/" + impl.films[f].name,
                      select_columns(impl.rest_film_vertices[f], impl.frame_layout.film_vertices[f]),
                      impl.frame_layout.film_corners[f], 4});
  }
  if (impl.stepper->tissue() != nullptr) {
    const solid::HexMesh& mesh = impl.stepper->tissue()->tissue.mesh();
    MeshTopology tissue{"tissue", geometry::to_points_mm(mesh.rest_positions), {}, 8};
    for (const auto& hexahedron : mesh.hexahedra) {
      for (const int v : hexahedron) tissue.cells.push_back(static_cast<uint32_t>(v));
    }
    meshes.push_back(std::move(tissue));
  }
  return meshes;
}

/// @param skin  displacement of the nodes of this simulation's skin [m]
void Simulation::Impl::add_skin_fields(const FrameLayout& layout, const Eigen::Matrix3Xd& skin, const FilmsNow& now,
                                       std::vector<FrameField>& fields) const {
  const int n = static_cast<int>(layout.skin.size());
  fields.push_back({"skin", "displacement", "mm", FieldLocation::kPoint, 3, move(layout.skin, n, skin)});
  fields.push_back(
      {"skin", "pressure", "Pa", FieldLocation::kPoint, 1, look_below(layout.skin, n, 1.0, now.pressures)});
  fields.push_back({"skin", "thickness", "mm", FieldLocation::kPoint, 1,
                    look_below(layout.skin, n, kMillimetresPerMetre, now.thicknesses)});
  fields.push_back({"skin", "zone", "", FieldLocation::kPoint, 1, look_below(layout.skin, n, 1.0, now.zones)});
}

/// @param n  vertices of the scan
void Simulation::Impl::add_scan_fields(const FrameLayout& layout, int n, const Eigen::Matrix3Xd& skin,
                                       const FilmsNow& now, std::vector<FrameField>& fields) const {
  fields.push_back({"scan", "displacement", "mm", FieldLocation::kPoint, 3, move(layout.scan, n, skin)});
  fields.push_back(
      {"scan", "pressure", "Pa", FieldLocation::kPoint, 1, look_below(layout.scan, n, 1.0, now.pressures)});
  fields.push_back({"scan", "thickness", "mm", FieldLocation::kPoint, 1,
                    look_below(layout.scan, n, kMillimetresPerMetre, now.thicknesses)});
}

void Simulation::Impl::add_film_fields(size_t f, const FilmsNow& now, std::vector<FrameField>& fields) const {
  const std::string name = "film/" + films[f].name;
  const mechanics::FilmState& film = state.films[f];
  const film::FilmMetric& metric = now.metric[f];
  fields.push_back({name, "displacement", "mm", FieldLocation::kPoint, 3,
                    select_moved(rest_film_vertices[f], metric.vertices, frame_layout.film_vertices[f])});
  fields.push_back(
      {name, "thickness", "mm", FieldLocation::kCell, 1, to_floats(now.thickness[f], kMillimetresPerMetre)});
  fields.push_back({name, "pressure", "Pa", FieldLocation::kCell, 1, to_floats(film.pressure, 1.0)});
  fields.push_back(
      {name, "velocity", "mm/s", FieldLocation::kCell, 3,
       to_floats(film::compute_cell_velocity(films[f].grid, metric, film.velocity), kMillimetresPerMetre)});
  std::vector<float> wet(static_cast<size_t>(film.volume.size()));
  for (size_t cell = 0; cell < wet.size(); ++cell) wet[cell] = film.volume[static_cast<int>(cell)] > 0.0 ? 1.0f : 0.0f;
  fields.push_back({name, "wet", "", FieldLocation::kCell, 1, std::move(wet)});
}

std::vector<FrameField> Simulation::frame_on(const geometry::FaceGeometry& face) const {
  const Impl& impl = *impl_;
  const FrameLayout layout = make_frame_layout(impl.model->geometry.grid, impl.films, face);
  const Eigen::Matrix3Xd skin = impl.skin_displacement();
  const Impl::FilmsNow now = impl.measure_films();
  std::vector<FrameField> fields;
  impl.add_skin_fields(layout, skin, now, fields);
  const auto n_scan = static_cast<int>(face.scan.n_vertices());
  if (n_scan > 0) impl.add_scan_fields(layout, n_scan, skin, now, fields);
  return fields;
}

std::vector<FrameField> Simulation::frame(const std::vector<std::string>& meshes) const {
  const Impl& impl = *impl_;
  const Eigen::Matrix3Xd skin = impl.skin_displacement();
  const Impl::FilmsNow now = impl.measure_films();
  std::vector<FrameField> fields;
  if (wanted(meshes, "skin")) impl.add_skin_fields(impl.frame_layout, skin, now, fields);
  const auto n_scan = static_cast<int>(impl.model->geometry.scan.n_vertices());
  if (n_scan > 0 && wanted(meshes, "scan")) impl.add_scan_fields(impl.frame_layout, n_scan, skin, now, fields);
  for (size_t f = 0; f < impl.films.size(); ++f) {
    if (wanted(meshes, "film/" + impl.films[f].name)) impl.add_film_fields(f, now, fields);
  }
  if (impl.stepper->tissue() != nullptr && wanted(meshes, "tissue")) {
    fields.push_back(
        {"tissue", "displacement", "mm", FieldLocation::kPoint, 3,
         to_floats(Eigen::Matrix3Xd(impl.state.positions - impl.stepper->tissue()->tissue.mesh().rest_positions),
                   kMillimetresPerMetre)});
  }
  return fields;
}

}  // namespace lipofill::simulation
