#include "core/plan/zone_outline.h"

#include <array>
#include <cstddef>
#include <map>

namespace lipofill::plan {
namespace {

/// The directed edges between a zone and what is not of it, by the vertex they begin at; the zone
/// lies to their left.
using Border = std::map<int, std::vector<int>>;

int zone_at(const film::FilmGrid& grid, int i, int j) {
  if (i < 0 || j < 0 || i >= grid.n_xi || j >= grid.n_eta) return -1;
  const int cell = grid.cell_of_slot[static_cast<size_t>(j) * grid.n_xi + i];
  return cell < 0 ? -1 : grid.zone_of_cell[cell];
}

void add_sides(const film::FilmGrid& grid, int cell, Border& border) {
  const int zone = grid.zone_of_cell[cell];
  const int i = grid.slot_i(grid.slot_of_cell[cell]);
  const int j = grid.slot_j(grid.slot_of_cell[cell]);
  const std::array<int, 4> corners = {grid.vertex(i, j), grid.vertex(i + 1, j), grid.vertex(i + 1, j + 1),
                                      grid.vertex(i, j + 1)};
  const std::array<int, 4> beyond = {zone_at(grid, i, j - 1), zone_at(grid, i + 1, j), zone_at(grid, i, j + 1),
                                     zone_at(grid, i - 1, j)};
  for (size_t side = 0; side < 4; ++side) {
    if (beyond[side] != zone) border[corners[side]].push_back(corners[(side + 1) % 4]);
  }
}

int take_edge_from(int vertex, Border& border) {
  const auto from = border.find(vertex);
  const int to = from->second.back();
  from->second.pop_back();
  if (from->second.empty()) border.erase(from);
  return to;
}

}  // namespace

std::vector<OutlineLoop> trace_zone_outline(const film::FilmGrid& grid, int zone) {
  Border border;
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    if (grid.zone_of_cell[cell] == zone) add_sides(grid, cell, border);
  }
  // As many edges lead into a vertex as out of it: a walk ends where it began.
  std::vector<OutlineLoop> loops;
  while (!border.empty()) {
    OutlineLoop& loop = loops.emplace_back();
    loop.push_back(border.begin()->first);
    for (int at = take_edge_from(loop[0], border); at != loop[0]; at = take_edge_from(at, border)) loop.push_back(at);
  }
  return loops;
}

}  // namespace lipofill::plan
