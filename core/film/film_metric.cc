#include "core/film/film_metric.h"

#include <Eigen/Geometry>

namespace lipofill::film {
namespace {

QuadrantMetric metric_of(const Eigen::Vector3d& g1, const Eigen::Vector3d& g2, double share) {
  return {g1.dot(g1), g1.dot(g2), g2.dot(g2), g1.cross(g2).norm(), share};
}

/// Corners of a slot.
struct SlotCorners {
  Eigen::Vector3d x00, x10, x01, x11;
  SlotCorners(const FilmGrid& grid, const Eigen::Matrix3Xd& vertices, int slot) {
    const int i = grid.slot_i(slot);
    const int j = grid.slot_j(slot);
    x00 = vertices.col(grid.vertex(i, j));
    x10 = vertices.col(grid.vertex(i + 1, j));
    x01 = vertices.col(grid.vertex(i, j + 1));
    x11 = vertices.col(grid.vertex(i + 1, j + 1));
  }
  std::array<QuadrantMetric, 4> quadrants(const SlotCover& cover) const {
    const std::array<Eigen::Vector3d, 2> g1 = {x10 - x00, x11 - x01};  // by t
    const std::array<Eigen::Vector3d, 2> g2 = {x01 - x00, x11 - x10};  // by s
    std::array<QuadrantMetric, 4> of_slot;
    for (int q = 0; q < 4; ++q) of_slot[q] = metric_of(g1[q >> 1], g2[q & 1], cover[q]);
    return of_slot;
  }
};

double area_of(const std::array<QuadrantMetric, 4>& quadrants) {
  double area = 0.0;
  for (const QuadrantMetric& quadrant : quadrants) area += 0.25 * quadrant.share * quadrant.sqrt_g;
  return area;
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
    const SlotCorners corners(grid, vertices, grid.slot_of_cell[cell]);
    metric.quadrants[cell] = corners.quadrants(grid.cover[cell]);
    metric.area[cell] = area_of(metric.quadrants[cell]);
    metric.centre.col(cell) = 0.25 * (corners.x00 + corners.x10 + corners.x01 + corners.x11);
  }
  for (const Fragment& fragment : grid.fragments) {
    metric.area[fragment.cell] += area_of(SlotCorners(grid, vertices, fragment.slot).quadrants(fragment.cover));
  }
}

}  // namespace lipofill::film
