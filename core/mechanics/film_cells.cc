#include "core/mechanics/film_cells.h"

#include <algorithm>

namespace lipofill::mechanics {

FilmCells number_cells(const std::vector<plan::FilmLayout>& films) {
  FilmCells cells;
  cells.offset = {0};
  int n_gaps = 0;
  for (const plan::FilmLayout& film : films) {
    const int first = cells.n();
    const bool is_on_tissue = film.wall == plan::FilmWallKind::kTissue;
    cells.offset.push_back(first + film.grid.n_cells());
    cells.gap_of_film.push_back(is_on_tissue ? n_gaps++ : -1);
    for (int cell = first; is_on_tissue && cell < cells.n(); ++cell) cells.on_tissue.push_back(cell);
  }
  return cells;
}

int FilmCells::film_of(int cell) const {
  return static_cast<int>(std::upper_bound(offset.begin(), offset.end(), cell) - offset.begin()) - 1;
}

void FilmCells::gather_tissue_part(const Eigen::VectorXd& all_cells, Eigen::VectorXd& part) const {
  part.resize(static_cast<Eigen::Index>(on_tissue.size()));
  for (size_t k = 0; k < on_tissue.size(); ++k) part[k] = all_cells[on_tissue[k]];
}

void FilmCells::gather(const SimulationState& state, Eigen::VectorXd FilmState::*values, Eigen::VectorXd& all) const {
  all.resize(n());
  for (size_t f = 0; f < state.films.size(); ++f) all.segment(offset[f], n_of(f)) = state.films[f].*values;
}

}  // namespace lipofill::mechanics
