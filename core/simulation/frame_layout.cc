#include "core/simulation/frame_layout.h"

#include <algorithm>
#include <map>

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

/// Tells whether a place lies inside loops, by the number of times a line from it crosses them.
bool lies_inside(const std::vector<geometry::OutlineLoop>& outline, const geometry::ChartPoint& place) {
  bool inside = false;
  for (const geometry::OutlineLoop& loop : outline) {
    for (size_t k = 0; k < loop.size(); ++k) {
      const geometry::ChartPoint& a = loop[k];
      const geometry::ChartPoint& b = loop[(k + 1) % loop.size()];
      if ((a.eta > place.eta) == (b.eta > place.eta)) continue;
      const double crossing = a.xi + (b.xi - a.xi) * (place.eta - a.eta) / (b.eta - a.eta);
      if (place.xi < crossing) inside = !inside;
    }
  }
  return inside;
}

/// The cells that an outline cuts: which zones have a part of a slot, and the cells it counts to.
class CutSlots {
 public:
  explicit CutSlots(const plan::FilmLayout& film) : film_(film) {
    const film::FilmGrid& grid = film.grid;
    for (int cell = 0; cell < grid.n_cells(); ++cell) {
      if (grid.cover[cell] != film::kWholeSlot) cells_[grid.slot_of_cell[cell]].push_back(cell);
    }
    for (const film::Fragment& fragment : grid.fragments) cells_[fragment.slot].push_back(fragment.cell);
  }

  /// The cell under a place, -1 where no zone is.
  int cell_at(const geometry::ChartPoint& place) const {
    const int slot = film_.slot_at(place);
    const auto cut = cells_.find(slot);
    if (cut == cells_.end()) return film_.cell_at(place);
    for (const int cell : cut->second) {
      if (lies_inside(film_.outlines[static_cast<size_t>(film_.grid.zone_of_cell[cell])], place)) return cell;
    }
    return -1;
  }

 private:
  const plan::FilmLayout& film_;
  std::map<int, std::vector<int>> cells_;  ///< by slot
};

void find_cell_below(const std::vector<CutSlots>& films, const std::vector<int>& outermost_first,
                     const geometry::ChartPoint& place, SkinPoint& point) {
  for (const int f : outermost_first) {
    const int cell = films[static_cast<size_t>(f)].cell_at(place);
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
  const std::vector<CutSlots> cut(films.begin(), films.end());
  const auto make_point = [&](int vertex, const geometry::ChartPoint& place) {
    SkinPoint point = place_on_skin(skin, place);
    point.vertex = vertex;
    find_cell_below(cut, outermost_first, place, point);
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
