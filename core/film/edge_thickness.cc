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

Eigen::VectorXd compute_edge_thickness(const FilmGrid& grid, const Eigen::VectorXd& h, const Eigen::VectorXd& flux) {
  Eigen::VectorXd thickness(grid.n_edges());
  for (int e = 0; e < grid.n_edges(); ++e) {
    const Edge& edge = grid.edges[e];
    const bool from_left = flux[e] >= 0.0;
    const double upstream = h[from_left ? edge.left : edge.right];
    const double downstream = h[from_left ? edge.right : edge.left];
    const int behind = cell_behind(grid, edge, from_left);
    const double slope = behind < 0 ? 0.0 : limited_slope(downstream - upstream, upstream - h[behind]);
    thickness[e] = upstream + 0.5 * slope;
  }
  return thickness;
}

}  // namespace lipofill::film
