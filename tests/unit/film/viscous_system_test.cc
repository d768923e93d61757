// The system of implicit viscosity against its terms, put together from their definitions.

#include "core/film/viscous_system.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace lipofill::film {
namespace {

constexpr double kDiffusion = 3e-5;  // [m2]

/// A film of 6 x 5 slots on a sheared and bent surface, with a hole of one cell and weights that
/// vary.
struct Case {
  FilmGrid grid;
  FilmMetric metric;
  Eigen::VectorXd weight, thickness;
  ViscousSystem system;

  Case() : grid(make()), metric(compute_film_metric(grid, bend())), system(grid) {
    weight = Eigen::VectorXd::LinSpaced(grid.n_edges(), 0.5e-3, 2e-3);
    thickness = Eigen::VectorXd::LinSpaced(grid.n_cells(), 1e-3, 0.2e-3);
    system.set_metric(grid, metric);
    system.set(grid, metric, weight, thickness, kDiffusion);
  }

  static FilmGrid make() {
    std::vector<int> zones(30, 0);
    zones[14] = -1;
    return make_film_grid({0, 1, 0, 1}, 6, 5, zones);
  }

  Eigen::Matrix3Xd bend() const {
    Eigen::Matrix3Xd vertices(3, grid.n_vertices());
    for (int j = 0; j <= 5; ++j) {
      for (int i = 0; i <= 6; ++i) {
        const double x = 2e-3 * i + 0.4e-3 * j;
        const double y = 1.5e-3 * j;
        vertices.col(grid.vertex(i, j)) << x, y, 40.0 * x * x + 15.0 * x * y;
      }
    }
    return vertices;
  }

  Eigen::MatrixXd matrix() {
    Eigen::MatrixXd A(grid.n_edges(), grid.n_edges());
    Eigen::VectorXd product;
    for (int e = 0; e < grid.n_edges(); ++e) {
      system.multiply(grid, Eigen::VectorXd::Unit(grid.n_edges(), e), product);
      A.col(e) = product;
    }
    return A;
  }
};

/// M(w), quadrant by quadrant, by the formula of compute_unit_mass_forms.
Eigen::MatrixXd make_mass(const Case& film, const Eigen::VectorXd& w) {
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(w.size(), w.size());
  for (int cell = 0; cell < film.grid.n_cells(); ++cell) {
    for (int q = 0; q < 4; ++q) {
      const QuadrantMetric& g = film.metric.quadrants[cell][q];
      const auto [a, b] = quadrant_edges(film.grid, cell, q);
      if (a >= 0) mass(a, a) += 0.25 / g.sqrt_g * w[a] * g.g11;
      if (b >= 0) mass(b, b) += 0.25 / g.sqrt_g * w[b] * g.g22;
      if (a < 0 || b < 0) continue;
      mass(a, b) += 0.25 / g.sqrt_g * std::sqrt(w[a] * w[b]) * g.g12;
      mass(b, a) += 0.25 / g.sqrt_g * std::sqrt(w[a] * w[b]) * g.g12;
    }
  }
  return mass;
}

/// D^T (s h/a) D.
Eigen::MatrixXd make_compression(const Case& film) {
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(film.grid.n_cells(), film.grid.n_edges());
  for (int e = 0; e < film.grid.n_edges(); ++e) {
    D(film.grid.edges[e].left, e) += 1.0;
    D(film.grid.edges[e].right, e) -= 1.0;
  }
  const Eigen::VectorXd scale = kDiffusion * film.thickness.cwiseQuotient(film.metric.area);
  return D.transpose() * scale.asDiagonal() * D;
}

/// K^T (s h/a_v) K: around each vertex of four cells whose edges are open, with a quarter of each
/// cell, the quadrant that touches the vertex.
Eigen::MatrixXd make_circulation(const Case& film, int& n_vertices) {
  const FilmGrid& grid = film.grid;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(grid.n_edges(), grid.n_edges());
  n_vertices = 0;
  for (int j = 1; j < grid.n_eta; ++j) {
    for (int i = 1; i < grid.n_xi; ++i) {
      const auto cell_at = [&](int k, int l) { return grid.cell_of_slot[l * grid.n_xi + k]; };
      const int sw = cell_at(i - 1, j - 1), se = cell_at(i, j - 1), nw = cell_at(i - 1, j), ne = cell_at(i, j);
      if (std::min({sw, se, nw, ne}) < 0) continue;
      ++n_vertices;
      Eigen::VectorXd k = Eigen::VectorXd::Zero(grid.n_edges());
      k[grid.edge_of_side[sw][kHighXi]] = 1.0;
      k[grid.edge_of_side[se][kHighEta]] = 1.0;
      k[grid.edge_of_side[nw][kHighXi]] = -1.0;
      k[grid.edge_of_side[sw][kHighEta]] = -1.0;
      const auto quarter = [&](int cell, int q) { return 0.25 * film.metric.quadrants[cell][q].sqrt_g; };
      const double area = quarter(sw, 3) + quarter(se, 2) + quarter(nw, 1) + quarter(ne, 0);
      const double volume = quarter(sw, 3) * film.thickness[sw] + quarter(se, 2) * film.thickness[se] +
                            quarter(nw, 1) * film.thickness[nw] + quarter(ne, 0) * film.thickness[ne];
      sum += kDiffusion * volume / (area * area) * k * k.transpose();
    }
  }
  return sum;
}

TEST(ViscousSystem, IsTheSumOfItsTerms) {
  Case film;
  int n_vertices = 0;
  const Eigen::MatrixXd unit = make_mass(film, Eigen::VectorXd::Ones(film.grid.n_edges()));
  const Eigen::MatrixXd circulation = unit * make_circulation(film, n_vertices) * unit;
  EXPECT_EQ(n_vertices, 20 - 4);  // the hole takes the vertices of its corners
  const Eigen::MatrixXd expected = make_mass(film, film.weight) + make_compression(film) + circulation;
  const Eigen::MatrixXd A = film.matrix();
  EXPECT_LT((A - expected).norm(), 1e-13 * expected.norm());
  EXPECT_GT(circulation.norm(), 1e-3 * expected.norm());
}

TEST(ViscousSystem, IsSymmetricAndPositiveDefinite) {
  Case film;
  const Eigen::MatrixXd A = film.matrix();
  EXPECT_LT((A - A.transpose()).norm(), 1e-14 * A.norm());
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(A).info(), Eigen::Success);
}

/// The diagonal leaves out only what the metric of slanted quadrants adds to the circulation.
TEST(ViscousSystem, DiagonalIsNearThatOfTheMatrix) {
  Case film;
  const Eigen::VectorXd exact = film.matrix().diagonal();
  EXPECT_LT((film.system.diagonal() - exact).cwiseQuotient(exact).cwiseAbs().maxCoeff(), 0.2);
  film.system.set(film.grid, film.metric, film.weight, Eigen::VectorXd::Zero(film.grid.n_cells()), kDiffusion);
  const Eigen::VectorXd of_mass = make_mass(film, film.weight).diagonal();
  EXPECT_LT((film.system.diagonal() - of_mass).norm(), 1e-14 * of_mass.norm());
}

}  // namespace
}  // namespace lipofill::film
