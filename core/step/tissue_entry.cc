#include "core/step/tissue_entry.h"

namespace lipofill::step {

bool enter_cells_beside_pressure(const plan::FilmLayout& layout, mechanics::FilmState& film) {
  if (film.is_entered.size() == 0) return false;
  const Eigen::VectorXd before = film.is_entered;  // fat enters one cell a step
  const auto presses = [&](int cell) {
    return before[cell] > 0.0 && film.pressure[cell] > layout.connective_tissue.entry_pressure;
  };
  const auto enter = [&](int left, int right) {
    if (presses(left)) film.is_entered[right] = 1.0;
    if (presses(right)) film.is_entered[left] = 1.0;
  };
  for (const film::Edge& edge : layout.grid.edges) enter(edge.left, edge.right);
  for (const film::LeakyWall& wall : layout.grid.leaky_walls) enter(wall.left, wall.right);
  return film.is_entered != before;
}

}  // namespace lipofill::step
