#include "core/film/edge_thickness.h"

namespace lipofill::film {
namespace {

double limited_slope(double ahead, double behind) {
  const double product = ahead * behind;
  return product > 0.0 ? 2.0 * product / (ahead + behind) : 0.0;
}

int cell_behind(const FilmGrid& grid, const Edge& edge, bool from_left) {
  if (from_left) return grid.neighbour(edge.left, edge.direction == 0 ? kLowXi : kLowEta);
  return grid.neighbour(edge.right, edge.direction == 0 ? kHighXi : kHighEta);
}

}  // namespace

void compute_edge_thickness(const FilmGrid& grid, const Eigen::Ref<const Eigen::VectorXd>& h,
                            const Eigen::Ref<const Eigen::VectorXd>& flux, Eigen::VectorXd& thickness) {
  thickness.resize(grid.n_edges());
  const double* of_cell = h.data();
  for (int e = 0; e < grid.n_edges(); ++e) {
    const Edge& edge = grid.edges[e];
    const bool from_left = flux.data()[e] >= 0.0;
    const double upstream = of_cell[from_left ? edge.left : edge.right];
    const double downstream = of_cell[from_left ? edge.right : edge.left];
    const int behind = cell_behind(grid, edge, from_left);
    const double slope = behind < 0 ? 0.0 : limited_slope(downstream - upstream, upstream - of_cell[behind]);
    thickness.data()[e] = upstream + 0.5 * slope;
  }
}

Eigen::VectorXd compute_edge_thickness(const FilmGrid& grid, const Eigen::Ref<const Eigen::VectorXd>& h,
                                       const Eigen::Ref<const Eigen::VectorXd>& flux) {
  Eigen::VectorXd thickness;
  compute_edge_thickness(grid, h, flux, thickness);
  return thickness;
}

}  // namespace lipofill::film
