#include "core/film/film_grid.h"

#include <algorithm>

namespace lipofill::film {
namespace {

/// True when a cell has fat beside a side: along xi or eta, at its high end or its low.
bool reaches_side(const SlotCover& cover, int direction, bool high) {
  constexpr double kLeast = 1e-6;
  if (direction == 0) return (high ? cover[1] + cover[3] : cover[0] + cover[2]) > kLeast;
  return (high ? cover[2] + cover[3] : cover[0] + cover[1]) > kLeast;
}

}  // namespace

int FilmGrid::neighbour(int cell, Side side) const {
  const int edge = edge_of_side[cell][side];
  if (edge < 0) return -1;
  return side == kHighXi || side == kHighEta ? edges[edge].right : edges[edge].left;
}

FilmGrid make_film_grid(const geometry::ChartBox& extent, int n_xi, int n_eta, const std::vector<int>& zone_of_slot,
                        const WalledSlots& walls, const std::vector<SlotCover>& cover_of_slot,
                        const std::vector<SlotFragment>& fragments) {
  FilmGrid grid;
  grid.extent = extent;
  grid.n_xi = n_xi;
  grid.n_eta = n_eta;
  const int n_slots = n_xi * n_eta;
  grid.cell_of_slot.assign(n_slots, -1);
  for (int slot = 0; slot < n_slots; ++slot) {
    if (zone_of_slot[slot] < 0) continue;
    grid.cell_of_slot[slot] = grid.n_cells();
    grid.slot_of_cell.push_back(slot);
    grid.zone_of_cell.push_back(zone_of_slot[slot]);
    grid.cover.push_back(cover_of_slot.empty() ? kWholeSlot : cover_of_slot[slot]);
  }
  grid.edge_of_side.assign(grid.n_cells(), {-1, -1, -1, -1});

  const auto open = [&](int left, int right_slot, int direction) {
    const int right = grid.cell_of_slot[right_slot];
    if (right < 0 || grid.zone_of_cell[left] != grid.zone_of_cell[right]) return;
    if (walls.contains({grid.slot_of_cell[left], right_slot})) return;
    if (!reaches_side(grid.cover[left], direction, true) || !reaches_side(grid.cover[right], direction, false)) return;
    grid.edge_of_side[left][direction == 0 ? kHighXi : kHighEta] = grid.n_edges();
    grid.edge_of_side[right][direction == 0 ? kLowXi : kLowEta] = grid.n_edges();
    grid.edges.push_back({left, right, direction});
  };
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const int slot = grid.slot_of_cell[cell];
    if (grid.slot_i(slot) + 1 < n_xi) open(cell, slot + 1, 0);
    if (grid.slot_j(slot) + 1 < n_eta) open(cell, slot + n_xi, 1);
  }
  for (const SlotFragment& fragment : fragments) {
    grid.fragments.push_back({grid.cell_of_slot[fragment.into_slot], fragment.slot, fragment.cover});
  }
  std::stable_sort(grid.fragments.begin(), grid.fragments.end(),
                   [](const Fragment& a, const Fragment& b) { return a.cell < b.cell; });
  return grid;
}

}  // namespace lipofill::film
