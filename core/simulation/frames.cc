#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "core/film/edge_operators.h"
#include "core/simulation/simulation_impl.h"

namespace lipofill::simulation {
namespace {

constexpr double kMillimetresPerMetre = 1e3;

std::vector<float> to_floats(const Eigen::Matrix3Xd& vectors, double scale) {
  std::vector<float> values(static_cast<size_t>(vectors.size()));
  std::transform(vectors.data(), vectors.data() + vectors.size(), values.begin(),
                 [scale](double v) { return static_cast<float>(v * scale); });
  return values;
}

std::vector<float> to_floats(const std::vector<double>& numbers, double scale) {
  std::vector<float> values;
  for (const double v : numbers) values.push_back(static_cast<float>(v * scale));
  return values;
}

std::vector<float> to_floats(const Eigen::VectorXd& numbers, double scale) {
  return to_floats(std::vector<double>(numbers.data(), numbers.data() + numbers.size()), scale);
}

bool wanted(const std::vector<std::string>& meshes, const std::string& name) {
  return meshes.empty() || std::find(meshes.begin(), meshes.end(), name) != meshes.end();
}

/// Vertices of a film's grid that cells touch, numbered in order.
std::vector<int> used_vertices(const film::FilmGrid& grid, std::vector<uint32_t>* cells) {
  std::map<int, uint32_t> number;
  const auto corners = [&](int cell) {
    const int i = grid.slot_i(grid.slot_of_cell[cell]);
    const int j = grid.slot_j(grid.slot_of_cell[cell]);
    return std::array<int, 4>{grid.vertex(i, j), grid.vertex(i + 1, j), grid.vertex(i + 1, j + 1),
                              grid.vertex(i, j + 1)};
  };
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    for (const int v : corners(cell)) number.emplace(v, 0);
  }
  std::vector<int> vertices;
  for (auto& [vertex, index] : number) {
    index = static_cast<uint32_t>(vertices.size());
    vertices.push_back(vertex);
  }
  if (cells == nullptr) return vertices;
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    for (const int v : corners(cell)) cells->push_back(number.at(v));
  }
  return vertices;
}

Eigen::Matrix3Xd select_columns(const Eigen::Matrix3Xd& all, const std::vector<int>& columns) {
  Eigen::Matrix3Xd selected(3, columns.size());
  for (size_t k = 0; k < columns.size(); ++k) selected.col(k) = all.col(columns[k]);
  return selected;
}

std::vector<geometry::ChartPoint> skin_node_places(const geometry::LayeredGrid& grid) {
  std::vector<geometry::ChartPoint> places;
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i)
      places.push_back({static_cast<double>(i) / grid.n_xi, static_cast<double>(j) / grid.n_eta});
  }
  return places;
}

/// Displacement of the skin at a place of the chart, bilinear between nodes.
Eigen::Vector3d displacement_at(const geometry::LayeredGrid& grid, const Eigen::Matrix3Xd& skin,
                                const geometry::ChartPoint& p) {
  const double x = std::clamp(p.xi, 0.0, 1.0) * grid.n_xi;
  const double y = std::clamp(p.eta, 0.0, 1.0) * grid.n_eta;
  const int i = std::min(static_cast<int>(x), grid.n_xi - 1);
  const int j = std::min(static_cast<int>(y), grid.n_eta - 1);
  const double s = x - i;
  const double t = y - j;
  return (1 - s) * (1 - t) * skin.col(grid.surface_index(i, j)) + s * (1 - t) * skin.col(grid.surface_index(i + 1, j)) +
         (1 - s) * t * skin.col(grid.surface_index(i, j + 1)) + s * t * skin.col(grid.surface_index(i + 1, j + 1));
}

}  // namespace

/// Pressure or thickness of the outermost film under each place, 0 where there is none.
std::vector<double> Simulation::Impl::film_value_on_skin(const std::vector<geometry::ChartPoint>& places,
                                                         bool pressure) const {
  std::vector<int> outermost_first(films.size());
  for (size_t f = 0; f < films.size(); ++f) outermost_first[f] = static_cast<int>(f);
  std::stable_sort(outermost_first.begin(), outermost_first.end(),
                   [&](int a, int b) { return films[a].level < films[b].level; });
  std::vector<Eigen::VectorXd> values;
  for (size_t f = 0; f < films.size(); ++f) {
    values.push_back(pressure ? state.films[f].pressure
                              : Eigen::VectorXd(state.films[f].volume.cwiseQuotient(
                                    stepper->film_metric(state, static_cast<int>(f)).area)));
  }
  std::vector<double> result(places.size(), 0.0);
  for (size_t k = 0; k < places.size(); ++k) {
    for (const int f : outermost_first) {
      const int cell = films[f].cell_at(places[k]);
      if (cell < 0) continue;
      result[k] = values[f][cell];
      break;
    }
  }
  return result;
}

std::vector<MeshTopology> Simulation::topology() const {
  const Impl& impl = *impl_;
  const geometry::FaceGeometry& face = impl.model->geometry;
  const geometry::LayeredGrid& grid = face.grid;
  std::vector<MeshTopology> meshes;

  MeshTopology skin{
      "skin", to_floats(Eigen::Matrix3Xd(grid.nodes.leftCols(grid.nodes_per_level())), kMillimetresPerMetre), {}, 4};
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) {
      for (const int v : {grid.surface_index(i, j), grid.surface_index(i + 1, j), grid.surface_index(i + 1, j + 1),
                          grid.surface_index(i, j + 1)}) {
        skin.cells.push_back(static_cast<uint32_t>(v));
      }
    }
  }
  meshes.push_back(std::move(skin));

  if (face.scan.n_vertices() > 0) {
    MeshTopology scan{"scan", to_floats(face.scan.points, kMillimetresPerMetre), {}, 3};
    for (const auto& triangle : face.scan.triangles) {
      for (const int v : triangle) scan.cells.push_back(static_cast<uint32_t>(v));
    }
    meshes.push_back(std::move(scan));
  }
  const SimulationState rest = impl.stepper->rest_state();
  for (size_t f = 0; f < impl.films.size(); ++f) {
    MeshTopology film{"film/" + impl.films[f].name, {}, {}, 4};
    const std::vector<int> vertices = used_vertices(impl.films[f].grid, &film.cells);
    film.points_mm = to_floats(select_columns(impl.stepper->film_metric(rest, static_cast<int>(f)).vertices, vertices),
                               kMillimetresPerMetre);
    meshes.push_back(std::move(film));
  }
  if (impl.stepper->tissue() != nullptr) {
    const solid::HexMesh& mesh = impl.stepper->tissue()->tissue.mesh();
    MeshTopology tissue{"tissue", to_floats(mesh.rest_positions, kMillimetresPerMetre), {}, 8};
    for (const auto& hexahedron : mesh.hexahedra) {
      for (const int v : hexahedron) tissue.cells.push_back(static_cast<uint32_t>(v));
    }
    meshes.push_back(std::move(tissue));
  }
  return meshes;
}

/// @param moved   displacement of the nodes of the skin [m] (3, n)
/// @param places  theirs in the chart
void Simulation::Impl::add_skin_fields(const Eigen::Matrix3Xd& moved, const std::vector<geometry::ChartPoint>& places,
                                       std::vector<FrameField>& fields) const {
  fields.push_back({"skin", "displacement", "mm", FieldLocation::kPoint, 3, to_floats(moved, kMillimetresPerMetre)});
  fields.push_back(
      {"skin", "pressure", "Pa", FieldLocation::kPoint, 1, to_floats(film_value_on_skin(places, true), 1.0)});
  fields.push_back({"skin", "thickness", "mm", FieldLocation::kPoint, 1,
                    to_floats(film_value_on_skin(places, false), kMillimetresPerMetre)});
}

/// @param skin  displacement of the nodes of this simulation's skin [m]
void Simulation::Impl::add_scan_fields(const geometry::FaceGeometry& face, const Eigen::Matrix3Xd& skin,
                                       std::vector<FrameField>& fields) const {
  Eigen::Matrix3Xd moved = Eigen::Matrix3Xd::Zero(3, face.scan.n_vertices());
  std::vector<geometry::ChartPoint> places;
  for (const geometry::Rider& rider : face.riders) {
    moved.col(rider.vertex) = displacement_at(model->geometry.grid, skin, rider.place);
    places.push_back(rider.place);
  }
  const std::vector<double> rider_pressure = film_value_on_skin(places, true);
  std::vector<double> pressure(face.scan.n_vertices(), 0.0);
  for (size_t k = 0; k < face.riders.size(); ++k) pressure[face.riders[k].vertex] = rider_pressure[k];
  fields.push_back({"scan", "displacement", "mm", FieldLocation::kPoint, 3, to_floats(moved, kMillimetresPerMetre)});
  fields.push_back({"scan", "pressure", "Pa", FieldLocation::kPoint, 1, to_floats(pressure, 1.0)});
}

std::vector<FrameField> Simulation::frame_on(const geometry::FaceGeometry& face) const {
  const Eigen::Matrix3Xd skin = impl_->skin_displacement();
  const std::vector<geometry::ChartPoint> places = skin_node_places(face.grid);
  Eigen::Matrix3Xd moved(3, places.size());
  for (size_t k = 0; k < places.size(); ++k) {
    moved.col(k) = displacement_at(impl_->model->geometry.grid, skin, places[k]);
  }
  std::vector<FrameField> fields;
  impl_->add_skin_fields(moved, places, fields);
  if (face.scan.n_vertices() > 0) impl_->add_scan_fields(face, skin, fields);
  return fields;
}

std::vector<FrameField> Simulation::frame(const std::vector<std::string>& meshes) const {
  const Impl& impl = *impl_;
  const geometry::FaceGeometry& face = impl.model->geometry;
  std::vector<FrameField> fields;
  const Eigen::Matrix3Xd skin = impl.skin_displacement();
  if (wanted(meshes, "skin")) impl.add_skin_fields(skin, skin_node_places(face.grid), fields);
  if (face.scan.n_vertices() > 0 && wanted(meshes, "scan")) impl.add_scan_fields(face, skin, fields);
  const SimulationState rest = impl.stepper->rest_state();
  for (size_t f = 0; f < impl.films.size(); ++f) {
    const std::string name = "film/" + impl.films[f].name;
    if (!wanted(meshes, name)) continue;
    const film::FilmGrid& grid = impl.films[f].grid;
    const FilmState& film = impl.state.films[f];
    const film::FilmMetric metric = impl.stepper->film_metric(impl.state, static_cast<int>(f));
    const Eigen::Matrix3Xd moved = metric.vertices - impl.stepper->film_metric(rest, static_cast<int>(f)).vertices;
    fields.push_back({name, "displacement", "mm", FieldLocation::kPoint, 3,
                      to_floats(select_columns(moved, used_vertices(grid, nullptr)), kMillimetresPerMetre)});
    fields.push_back({name, "thickness", "mm", FieldLocation::kCell, 1,
                      to_floats(Eigen::VectorXd(film.volume.cwiseQuotient(metric.area)), kMillimetresPerMetre)});
    fields.push_back({name, "pressure", "Pa", FieldLocation::kCell, 1, to_floats(film.pressure, 1.0)});
    fields.push_back({name, "velocity", "mm/s", FieldLocation::kCell, 3,
                      to_floats(film::compute_cell_velocity(grid, metric, film.velocity), kMillimetresPerMetre)});
    std::vector<float> wet;
    for (const double volume : film.volume) wet.push_back(volume > 0.0 ? 1.0f : 0.0f);
    fields.push_back({name, "wet", "", FieldLocation::kCell, 1, std::move(wet)});
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
