#pragma once

#include <array>
#include <set>
#include <utility>
#include <vector>

#include "core/geometry/chart_box.h"

namespace lipofill::film {

/// Sides of a cell, and at the same time the order of `FilmGrid::edge_of_side`.
enum Side { kLowXi = 0, kHighXi = 1, kLowEta = 2, kHighEta = 3 };

/// An open edge between two cells; fat flows through it. Its positive direction is from `left` to
/// `right`, along +xi or +eta.
struct Edge {
  int left = 0;
  int right = 0;
  int direction = 0;  ///< 0: the edge is crossed along xi, 1: along eta
};

/// A wall between two adjacent cells that fat seeps through, F = conductance (p_left - p_right).
struct LeakyWall {
  int left = 0;
  int right = 0;
  double conductance = 0.0;  ///< [m3/(Pa s)]
};

/// Shares of a slot's quarters (quadrants, film_metric.h) that lie inside a zone's outline.
using SlotCover = std::array<double, 4>;
inline constexpr SlotCover kWholeSlot = {1.0, 1.0, 1.0, 1.0};

/// A fragment is what a zone covers of a slot that is not its own cell, or too little to be one: it
/// counts as part of the cell beside.
struct Fragment {
  int cell = 0;
  int slot = 0;
  SlotCover cover = kWholeSlot;
};

/// Topology of the staggered film grid: n_xi x n_eta slots over a box of the chart, of which those
/// in a zone are cells. Pressure and volume live on cells, velocity on the open edges. Edges
/// between two zones, or between a cell and no cell, are sealed walls and are not in the list.
struct FilmGrid {
  geometry::ChartBox extent;
  int n_xi = 0;
  int n_eta = 0;
  std::vector<int> cell_of_slot;  ///< (n_xi * n_eta), xi fastest; -1: no cell
  std::vector<int> slot_of_cell;
  std::vector<int> zone_of_cell;
  std::vector<SlotCover> cover;                  ///< a cell; less than whole where an outline cuts its slot
  std::vector<Fragment> fragments;               ///< ascending in cell
  std::vector<Edge> edges;                       ///< ascending in slot of the left cell, xi before eta
  std::vector<std::array<int, 4>> edge_of_side;  ///< a cell's edges by Side; -1: sealed
  std::vector<LeakyWall> leaky_walls;            ///< sealed edges that are not quite tight

  int n_cells() const { return static_cast<int>(slot_of_cell.size()); }
  int n_edges() const { return static_cast<int>(edges.size()); }
  int n_vertices() const { return (n_xi + 1) * (n_eta + 1); }
  int vertex(int i, int j) const { return j * (n_xi + 1) + i; }
  int slot_i(int slot) const { return slot % n_xi; }
  int slot_j(int slot) const { return slot / n_xi; }
  /// The cell beyond a side, -1 when the side is sealed.
  int neighbour(int cell, Side side) const;
  double vertex_xi(int i) const { return extent.xi_min + (extent.xi_max - extent.xi_min) * i / n_xi; }
  double vertex_eta(int j) const { return extent.eta_min + (extent.eta_max - extent.eta_min) * j / n_eta; }
};

/// Slots on the two sides of a wall inside a zone, the lower one first.
using WalledSlots = std::set<std::pair<int, int>>;

/// A fragment is what a zone covers of a slot, by slot; see FilmGrid::fragments.
struct SlotFragment {
  int into_slot = 0;  ///< the slot of the cell that it counts to
  int slot = 0;
  SlotCover cover = kWholeSlot;
};

/// Numbers cells and edges. `zone_of_slot`: (n_xi * n_eta), -1 where there is no film. Edges in
/// `walls` are sealed, and so are those at which the fat of one of the cells ends before it.
/// `cover_of_slot`: empty where every cell is whole.
/// Checked by tests/unit/film/edge_operators_test.cc.
FilmGrid make_film_grid(const geometry::ChartBox& extent, int n_xi, int n_eta, const std::vector<int>& zone_of_slot,
                        const WalledSlots& walls = {}, const std::vector<SlotCover>& cover_of_slot = {},
                        const std::vector<SlotFragment>& fragments = {});

}  // namespace lipofill::film
