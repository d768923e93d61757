#include "core/film/cell_pieces.h"

#include <algorithm>
#include <cmath>

namespace lipofill::film {
namespace {

/// Ends of [low, high] and every line k/n strictly between them.
std::vector<double> cut_at_grid_lines(double low, double high, int n) {
  constexpr double kSliver = 1e-9;
  std::vector<double> cuts = {low};
  for (int k = static_cast<int>(std::floor(low * n)) + 1; k < n && static_cast<double>(k) / n < high; ++k) {
    const double line = static_cast<double>(k) / n;
    if (line - cuts.back() > kSliver && high - line > kSliver) cuts.push_back(line);
  }
  cuts.push_back(high);
  return cuts;
}

int interval_of(double value, int n) {
  return std::clamp(static_cast<int>(std::floor(value * n)), 0, n - 1);
}

}  // namespace

std::vector<CellPiece> cut_cells(const FilmGrid& film, int n_xi, int n_eta) {
  std::vector<CellPiece> pieces;
  const auto add_slot = [&](int cell, int slot) {
    const int i = film.slot_i(slot);
    const int j = film.slot_j(slot);
    const std::vector<double> xi = cut_at_grid_lines(film.vertex_xi(i), film.vertex_xi(i + 1), n_xi);
    const std::vector<double> eta = cut_at_grid_lines(film.vertex_eta(j), film.vertex_eta(j + 1), n_eta);
    for (size_t b = 0; b + 1 < eta.size(); ++b) {
      for (size_t a = 0; a + 1 < xi.size(); ++a) {
        const geometry::ChartBox box{xi[a], xi[a + 1], eta[b], eta[b + 1]};
        const int quad_i = interval_of(0.5 * (box.xi_min + box.xi_max), n_xi);
        const int quad_j = interval_of(0.5 * (box.eta_min + box.eta_max), n_eta);
        pieces.push_back({cell, quad_i, quad_j, box});
      }
    }
  };
  auto fragment = film.fragments.begin();
  for (int cell = 0; cell < film.n_cells(); ++cell) {
    add_slot(cell, film.slot_of_cell[cell]);
    for (; fragment != film.fragments.end() && fragment->cell == cell; ++fragment) add_slot(cell, fragment->slot);
  }
  return pieces;
}

}  // namespace lipofill::film
