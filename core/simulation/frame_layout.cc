#include "core/simulation/frame_layout.h"

#include <algorithm>

namespace lipofill::simulation {
namespace {

/// Bilinear between nodes.
SkinPoint place_on_skin(const geometry::LayeredGrid& grid, const geometry::ChartPoint& p) {
  const double x = std::clamp(p.xi, 0.0, 1.0) * grid.n_xi;
  const double y = std::clamp(p.eta, 0.0, 1.0) * grid.n_eta;
  const int i = std::min(static_cast<int>(x), grid.n_xi - 1);
  const int j = std::min(static_cast<int>(y), grid.n_eta - 1);
  const double s = x - i;
  const double t = y - j;
  SkinPoint point;
  point.nodes = {grid.surface_index(i, j), grid.surface_index(i + 1, j), grid.surface_index(i, j + 1),
                 grid.surface_index(i + 1, j + 1)};
  point.weights = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
  return point;
}

std::vector<int> order_outermost_first(const std::vector<plan::FilmLayout>& films) {
  std::vector<int> order(films.size());
  for (size_t f = 0; f < films.size(); ++f) order[f] = static_cast<int>(f);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return films[a].level < films[b].level; });
  return order;
}

void find_cell_below(const std::vector<plan::FilmLayout>& films, const std::vector<int>& outermost_first,
                     const geometry::ChartPoint& place, SkinPoint& point) {
  for (const int f : outermost_first) {
    const int cell = films[f].cell_at(place);
    if (cell < 0) continue;
    point.film = f;
    point.cell = cell;
    return;
  }
}

std::array<int, 4> find_corners(const film::FilmGrid& grid, int cell) {
  const int i = grid.slot_i(grid.slot_of_cell[cell]);
  const int j = grid.slot_j(grid.slot_of_cell[cell]);
  return {grid.vertex(i, j), grid.vertex(i + 1, j), grid.vertex(i + 1, j + 1), grid.vertex(i, j + 1)};
}

void add_film(const film::FilmGrid& grid, FrameLayout& layout) {
  std::vector<int> number((grid.n_xi + 1) * (grid.n_eta + 1), -1);
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    for (const int vertex : find_corners(grid, cell)) number[vertex] = 0;
  }
  std::vector<int>& vertices = layout.film_vertices.emplace_back();
  for (size_t vertex = 0; vertex < number.size(); ++vertex) {
    if (number[vertex] < 0) continue;
    number[vertex] = static_cast<int>(vertices.size());
    vertices.push_back(static_cast<int>(vertex));
  }
  std::vector<uint32_t>& corners = layout.film_corners.emplace_back();
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    for (const int vertex : find_corners(grid, cell)) corners.push_back(static_cast<uint32_t>(number[vertex]));
  }
}

}  // namespace

FrameLayout make_frame_layout(const geometry::LayeredGrid& skin, const std::vector<plan::FilmLayout>& films,
                              const geometry::FaceGeometry& face) {
  FrameLayout layout;
  const std::vector<int> outermost_first = order_outermost_first(films);
  const auto make_point = [&](int vertex, const geometry::ChartPoint& place) {
    SkinPoint point = place_on_skin(skin, place);
    point.vertex = vertex;
    find_cell_below(films, outermost_first, place, point);
    return point;
  };
  const geometry::LayeredGrid& shown = face.grid;
  for (int j = 0; j <= shown.n_eta; ++j) {
    for (int i = 0; i <= shown.n_xi; ++i) {
      const geometry::ChartPoint place{static_cast<double>(i) / shown.n_xi, static_cast<double>(j) / shown.n_eta};
      layout.skin.push_back(make_point(shown.surface_index(i, j), place));
    }
  }
  for (const geometry::Rider& rider : face.riders) layout.scan.push_back(make_point(rider.vertex, rider.place));
  for (const plan::FilmLayout& film : films) add_film(film.grid, layout);
  return layout;
}

}  // namespace lipofill::simulation
