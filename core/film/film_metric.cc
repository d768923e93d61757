#include "core/film/film_metric.h"

#include <Eigen/Geometry>

namespace lipofill::film {
namespace {

QuadrantMetric metric_of(const Eigen::Vector3d& g1, const Eigen::Vector3d& g2) {
  return {g1.dot(g1), g1.dot(g2), g2.dot(g2), g1.cross(g2).norm()};
}

}  // namespace

FilmMetric compute_film_metric(const FilmGrid& grid, const Eigen::Matrix3Xd& vertices) {
  FilmMetric metric;
  metric.vertices = vertices;
  update_film_metric(grid, metric);
  return metric;
}

void update_film_metric(const FilmGrid& grid, FilmMetric& metric) {
  const Eigen::Matrix3Xd& vertices = metric.vertices;
  metric.quadrants.resize(grid.n_cells());
  metric.area.resize(grid.n_cells());
  metric.centre.resize(3, grid.n_cells());
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const int i = grid.slot_i(grid.slot_of_cell[cell]);
    const int j = grid.slot_j(grid.slot_of_cell[cell]);
    const Eigen::Vector3d x00 = vertices.col(grid.vertex(i, j));
    const Eigen::Vector3d x10 = vertices.col(grid.vertex(i + 1, j));
    const Eigen::Vector3d x01 = vertices.col(grid.vertex(i, j + 1));
    const Eigen::Vector3d x11 = vertices.col(grid.vertex(i + 1, j + 1));
    const std::array<Eigen::Vector3d, 2> g1 = {x10 - x00, x11 - x01};  // t is the index
    const std::array<Eigen::Vector3d, 2> g2 = {x01 - x00, x11 - x10};  // s is the index
    double area = 0.0;
    for (int q = 0; q < 4; ++q) {
      metric.quadrants[cell][q] = metric_of(g1[q >> 1], g2[q & 1]);
      area += 0.25 * metric.quadrants[cell][q].sqrt_g;
    }
    metric.area[cell] = area;
    metric.centre.col(cell) = 0.25 * (x00 + x10 + x01 + x11);
  }
}

}  // namespace lipofill::film
