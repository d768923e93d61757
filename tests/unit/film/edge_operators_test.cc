#include "core/film/edge_operators.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>

#include "core/film/edge_thickness.h"
#include "core/film/film_grid.h"
#include "core/film/film_metric.h"

namespace lipofill::film {
namespace {

using Map = std::function<Eigen::Vector3d(double, double)>;

Eigen::Matrix3Xd place_vertices(const FilmGrid& grid, const Map& map) {
  Eigen::Matrix3Xd vertices(3, grid.n_vertices());
  for (int j = 0; j <= grid.n_eta; ++j) {
    for (int i = 0; i <= grid.n_xi; ++i) vertices.col(grid.vertex(i, j)) = map(grid.vertex_xi(i), grid.vertex_eta(j));
  }
  return vertices;
}

FilmGrid full_grid(int n_xi, int n_eta) {
  return make_film_grid({0, 1, 0, 1}, n_xi, n_eta, std::vector<int>(n_xi * n_eta, 0));
}

/// Skewed, stretched and curved.
Eigen::Vector3d warped(double xi, double eta) {
  const double x = xi + 0.3 * eta + 0.05 * std::sin(2.0 * xi);
  const double y = 0.8 * eta + 0.1 * xi * eta;
  return {x, y, 0.3 * std::sin(x) * std::cos(y)};
}

TEST(FilmGridTest, SealsZonesFromEachOtherAndFromOutside) {
  // Two zones side by side with a hole: 0 0 1 / 0 . 1
  const FilmGrid grid = make_film_grid({0, 1, 0, 1}, 3, 2, {0, 0, 1, 0, -1, 1});
  EXPECT_EQ(grid.n_cells(), 5);
  EXPECT_EQ(grid.n_edges(), 3);
  EXPECT_EQ(grid.neighbour(grid.cell_of_slot[0], kHighXi), grid.cell_of_slot[1]);
  EXPECT_EQ(grid.neighbour(grid.cell_of_slot[1], kHighXi), -1);
  EXPECT_EQ(grid.neighbour(grid.cell_of_slot[1], kHighEta), -1);
  EXPECT_EQ(grid.neighbour(grid.cell_of_slot[2], kHighEta), grid.cell_of_slot[5]);
}

TEST(PressureOperatorTest, IsSymmetricSemiDefiniteWithConstantsInItsNullSpace) {
  const FilmGrid grid = make_film_grid({0, 1, 0, 1}, 7, 6, [] {
    std::vector<int> zones(42, 0);
    zones[3] = zones[17] = zones[40] = -1;
    return zones;
  }());
  const FilmMetric metric = compute_film_metric(grid, place_vertices(grid, warped));
  const Eigen::VectorXd k = Eigen::VectorXd::LinSpaced(grid.n_edges(), 0.1, 3.0);
  PressureOperator op(grid);
  const Eigen::MatrixXd j = op.assemble(grid, metric, k);
  EXPECT_EQ(j, Eigen::MatrixXd(j.transpose()));
  EXPECT_LT((j * Eigen::VectorXd::Ones(grid.n_cells())).cwiseAbs().maxCoeff(), 1e-13);
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(j).eigenvalues();
  EXPECT_GT(eigenvalues[0], -1e-13);
  EXPECT_GT(eigenvalues[1], 1e-3);
  // J is the outflow of the flux it stands for.
  const Eigen::VectorXd p = Eigen::VectorXd::Random(grid.n_cells());
  const Eigen::VectorXd flux = -apply_conductance(grid, metric, k, compute_edge_difference(grid, p));
  EXPECT_LT((j * p - compute_outflow(grid, flux)).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(PressureOperatorTest, GradientAndOutflowAreAdjoint) {
  const FilmGrid grid = full_grid(5, 4);
  const Eigen::VectorXd p = Eigen::VectorXd::Random(grid.n_cells());
  const Eigen::VectorXd flux = Eigen::VectorXd::Random(grid.n_edges());
  EXPECT_NEAR(compute_edge_difference(grid, p).dot(flux), -p.dot(compute_outflow(grid, flux)), 1e-13);
}

/// A plane skewed and stretched, x = xi + eta/2 + xi^2/10, y = eta, and the harmonic p = exp(x)
/// sin(y): the outflow of inner cells is zero.
double flux_error_on_skewed_plane(int n) {
  const FilmGrid grid = full_grid(n, n);
  const Map shear = [](double xi, double eta) { return Eigen::Vector3d(xi + 0.5 * eta + 0.1 * xi * xi, eta, 0.0); };
  const FilmMetric metric = compute_film_metric(grid, place_vertices(grid, shear));
  Eigen::VectorXd p(grid.n_cells());
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const double x = metric.centre(0, cell);
    const double y = metric.centre(1, cell);
    p[cell] = std::exp(x) * std::sin(y);
  }
  const Eigen::VectorXd flux =
      -apply_conductance(grid, metric, Eigen::VectorXd::Ones(grid.n_edges()), compute_edge_difference(grid, p));
  const Eigen::VectorXd outflow = compute_outflow(grid, flux);
  double sum = 0.0;
  double area = 0.0;
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const int i = grid.slot_i(grid.slot_of_cell[cell]);
    const int j = grid.slot_j(grid.slot_of_cell[cell]);
    if (i < n / 8 || j < n / 8 || i >= n - n / 8 || j >= n - n / 8) continue;
    sum += outflow[cell] * outflow[cell] / metric.area[cell];
    area += metric.area[cell];
  }
  return std::sqrt(sum / area);
}

TEST(PressureOperatorTest, IsSecondOrderOnASkewedStretchedChart) {
  const double coarse = flux_error_on_skewed_plane(16);
  const double fine = flux_error_on_skewed_plane(32);
  EXPECT_GT(std::log2(coarse / fine), 1.8) << coarse << " " << fine;
}

TEST(EdgeThickness, IsCentralWhereLinearAndUpwindAtAFront) {
  const FilmGrid grid = full_grid(6, 1);
  const Eigen::VectorXd h = (Eigen::VectorXd(6) << 1, 2, 3, 4, 0.5, 0).finished();
  const Eigen::VectorXd forward = Eigen::VectorXd::Ones(5);
  const Eigen::VectorXd right = compute_edge_thickness(grid, h, forward);
  EXPECT_DOUBLE_EQ(right[0], 1.0);  // nothing behind the first cell
  EXPECT_DOUBLE_EQ(right[1], 2.5);
  EXPECT_DOUBLE_EQ(right[2], 3.5);
  EXPECT_DOUBLE_EQ(right[3], 4.0);  // a maximum is not reconstructed
  const Eigen::VectorXd left = compute_edge_thickness(grid, h, -forward);
  EXPECT_DOUBLE_EQ(left[4], 0.0);  // nothing flows out of a dry cell
  for (const Eigen::VectorXd& e : {right, left}) EXPECT_GE(e.minCoeff(), 0.0);
}

TEST(FilmMetricTest, AreaOfASphericalPatchConvergesToSecondOrder) {
  const Map sphere = [](double xi, double eta) {
    return Eigen::Vector3d(std::sin(xi) * std::cos(eta), std::sin(eta), std::cos(xi) * std::cos(eta));
  };
  const auto error = [&](int n) {
    const FilmGrid grid = full_grid(n, n);
    return compute_film_metric(grid, place_vertices(grid, sphere)).area.sum() / std::sin(1.0) - 1.0;
  };
  EXPECT_GT(std::log2(std::abs(error(8) / error(16))), 1.9);
}

TEST(CellVelocity, OfAUniformFlowIsThatFlow) {
  const FilmGrid grid = full_grid(6, 5);
  const Map shear = [](double xi, double eta) { return Eigen::Vector3d(2.0 * xi + 0.5 * eta, eta, 0.0); };
  const FilmMetric metric = compute_film_metric(grid, place_vertices(grid, shear));
  const Eigen::Vector3d u(0.3, -0.2, 0.0);
  Eigen::VectorXd edge_velocity(grid.n_edges());
  // Flux through an edge of a plane: u . (tangent rotated), in index coordinates sqrt(g) u^a.
  const Eigen::Vector3d g1(2.0 / 6, 0, 0);
  const Eigen::Vector3d g2(0.5 / 5, 1.0 / 5, 0);
  const double sqrt_g = g1.x() * g2.y() - g1.y() * g2.x();
  const double u2 = u.y() / g2.y();
  const double u1 = (u.x() - u2 * g2.x()) / g1.x();
  for (int e = 0; e < grid.n_edges(); ++e) edge_velocity[e] = sqrt_g * (grid.edges[e].direction == 0 ? u1 : u2);
  const Eigen::Matrix3Xd velocity = compute_cell_velocity(grid, metric, edge_velocity);
  for (int cell = 0; cell < grid.n_cells(); ++cell) {
    const auto& sides = grid.edge_of_side[cell];
    if (*std::min_element(sides.begin(), sides.end()) < 0) continue;  // walls stop the flow
    EXPECT_LT((velocity.col(cell) - u).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace lipofill::film
