#include "core/coupling/gap_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "core/coupling/split_mesh.h"

namespace lipofill::coupling {
namespace {

/// A single level of n_xi x n_eta quadrilaterals with two copies of each node: outer nodes first.
struct TwoWalls {
  geometry::LayeredGrid grid;
  WallNodes walls;
  Eigen::Matrix3Xd positions;
  std::vector<int> dofs;

  TwoWalls(int n_xi, int n_eta, double length_xi, double length_eta) {
    grid.n_xi = n_xi;
    grid.n_eta = n_eta;
    const int n = grid.nodes_per_level();
    positions.resize(3, 2 * n);
    for (int j = 0; j <= n_eta; ++j) {
      for (int i = 0; i <= n_xi; ++i) {
        const Eigen::Vector3d x(length_xi * i / n_xi, length_eta * j / n_eta, 0.0);
        positions.col(grid.surface_index(i, j)) = positions.col(n + grid.surface_index(i, j)) = x;
      }
    }
    for (int s = 0; s < n; ++s) {
      walls.outer.push_back(s);
      walls.inner.push_back(n + s);
    }
    dofs.resize(6 * n);
    std::iota(dofs.begin(), dofs.end(), 0);
  }
  int n_dofs() const { return static_cast<int>(dofs.size()); }
};

film::FilmGrid full_film(int n_xi, int n_eta) {
  return film::make_film_grid({0.05, 0.95, 0.1, 0.9}, n_xi, n_eta, std::vector<int>(n_xi * n_eta, 0));
}

void shake(Eigen::Matrix3Xd& positions, double amplitude) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-amplitude, amplitude);
  for (double& x : positions.reshaped()) x += uniform(random);
}

TEST(GapVolume, LiftedWallHoldsAreaTimesHeight) {
  TwoWalls walls(7, 5, 0.07, 0.05);
  walls.positions.row(2).head(walls.grid.nodes_per_level()).array() += 2e-3;
  GapVolume gap(walls.grid, walls.walls, full_film(3, 2), walls.dofs, walls.n_dofs());
  gap.evaluate(walls.positions);
  // Cells that do not match the quadrilaterals still add up: 0.9 x 0.8 of the plate.
  EXPECT_NEAR(gap.volume().sum(), 0.9 * 0.07 * 0.8 * 0.05 * 2e-3, 1e-18);
  for (const double v : gap.volume()) EXPECT_NEAR(v, gap.volume()[0], 1e-18);
}

TEST(GapVolume, ShellBetweenSphereCapsHasTheClosedForm) {
  // Walls of radius r and r + d over the same solid angle: volume (R2^3 - R1^3)/3 * solid angle;
  // second order in the mesh.
  const double inner = 0.05;
  const double outer = 0.054;
  const double half_angle = 0.4;
  const auto error = [&](int n) {
    TwoWalls walls(n, n, 1.0, 1.0);
    const int count = walls.grid.nodes_per_level();
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const double a = half_angle * (2.0 * i / n - 1.0);
        const double b = half_angle * (2.0 * j / n - 1.0);
        const Eigen::Vector3d direction(std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b));
        walls.positions.col(walls.grid.surface_index(i, j)) = outer * direction;
        walls.positions.col(count + walls.grid.surface_index(i, j)) = inner * direction;
      }
    }
    const film::FilmGrid film =
        film::make_film_grid({0.0, 1.0, 0.0, 1.0}, n / 2, n / 2, std::vector<int>(n * n / 4, 0));
    GapVolume gap(walls.grid, walls.walls, film, walls.dofs, walls.n_dofs());
    gap.evaluate(walls.positions);
    const double solid_angle = 2.0 * half_angle * 2.0 * std::sin(half_angle);
    const double exact = solid_angle * (std::pow(outer, 3) - std::pow(inner, 3)) / 3.0;
    return gap.volume().sum() / exact - 1.0;
  };
  const double coarse = error(8);
  const double fine = error(16);
  EXPECT_LT(std::abs(fine), 1e-2);
  EXPECT_GT(std::log2(std::abs(coarse / fine)), 1.9);
}

TEST(GapVolume, DerivativeIsThatOfTheVolume) {
  TwoWalls walls(6, 6, 0.06, 0.06);
  walls.positions.row(2).head(walls.grid.nodes_per_level()).array() += 2e-3;
  shake(walls.positions, 1e-3);
  GapVolume gap(walls.grid, walls.walls, full_film(2, 3), walls.dofs, walls.n_dofs());
  gap.evaluate(walls.positions);
  const Eigen::MatrixXd b = gap.derivative();
  const double step = 1e-6;
  double worst = 0.0;
  for (int k = 0; k < walls.n_dofs(); ++k) {
    const double x = walls.positions.data()[k];
    walls.positions.data()[k] = x + step;
    gap.evaluate(walls.positions);
    const Eigen::VectorXd high = gap.volume();
    walls.positions.data()[k] = x - step;
    gap.evaluate(walls.positions);
    worst = std::max(worst, ((high - gap.volume()) / (2.0 * step) - b.col(k)).cwiseAbs().maxCoeff());
    walls.positions.data()[k] = x;
  }
  EXPECT_LT(worst, 1e-9 * b.cwiseAbs().maxCoeff() + 1e-13);
}

TEST(GapVolume, VolumeAloneHasTheSameBits) {
  TwoWalls walls(6, 6, 0.06, 0.06);
  shake(walls.positions, 1e-3);
  GapVolume both(walls.grid, walls.walls, full_film(3, 3), walls.dofs, walls.n_dofs());
  GapVolume alone(both.geometry());
  both.evaluate(walls.positions);
  alone.evaluate_volume(walls.positions);
  EXPECT_EQ(both.volume(), alone.volume());
  EXPECT_GT(both.derivative().norm(), 0.0);
  EXPECT_EQ(alone.derivative().norm(), 0.0);
}

/// A cell whose walls are bonded at every node gives way to nothing, to the last bit: that is how
/// it is found.
TEST(GapVolume, BondedWallsCannotPart) {
  TwoWalls walls(4, 4, 0.04, 0.04);
  walls.walls.inner = walls.walls.outer;
  shake(walls.positions, 1e-3);
  GapVolume gap(walls.grid, walls.walls, full_film(3, 3), walls.dofs, walls.n_dofs());
  gap.evaluate(walls.positions);
  EXPECT_EQ(gap.volume().norm(), 0.0);
  EXPECT_EQ(gap.derivative().norm(), 0.0);
}

TEST(GapVolume, PressureForceHasNoResultantOnAClosedGap) {
  // Action equals reaction: moving everything together changes no gap.
  TwoWalls walls(6, 6, 0.06, 0.06);
  walls.positions.row(2).head(walls.grid.nodes_per_level()).array() += 2e-3;
  shake(walls.positions, 1e-3);
  GapVolume gap(walls.grid, walls.walls, full_film(2, 3), walls.dofs, walls.n_dofs());
  gap.evaluate(walls.positions);
  const Eigen::VectorXd force = gap.derivative().transpose() * Eigen::VectorXd::Ones(gap.volume().size());
  Eigen::Vector3d resultant = Eigen::Vector3d::Zero();
  for (int node = 0; node < walls.positions.cols(); ++node) resultant += force.segment<3>(3 * node);
  EXPECT_LT(resultant.norm(), 1e-13 * force.cwiseAbs().sum());
}

TEST(GapVolume, SweptVolumeOfALiftedSurface) {
  TwoWalls walls(4, 3, 0.04, 0.03);
  const int n = walls.grid.nodes_per_level();
  const Eigen::Matrix3Xd rest = walls.positions.leftCols(n);
  Eigen::Matrix3Xd lifted = rest;
  lifted.row(2).array() += 1e-3;
  EXPECT_NEAR(compute_swept_volume(walls.grid, rest, lifted), 0.04 * 0.03 * 1e-3, 1e-18);
  EXPECT_NEAR(compute_swept_volume(walls.grid, lifted, rest), -0.04 * 0.03 * 1e-3, 1e-18);
}

TEST(SplitMesh, DoublesOpenNodesAndLaysBoneUnderTheBase) {
  geometry::LayeredGrid grid;
  grid.n_xi = grid.n_eta = 4;
  grid.elements_through = {1, 2};
  grid.nodes = Eigen::Matrix3Xd::Random(3, grid.n_levels() * grid.nodes_per_level());
  std::vector<std::vector<bool>> open(grid.n_levels());
  open[1].assign(grid.nodes_per_level(), false);
  open[1][grid.surface_index(2, 2)] = true;
  open[3].assign(grid.nodes_per_level(), false);
  open[3][grid.surface_index(1, 1)] = true;
  const SplitMesh split = split_mesh(grid, open);
  EXPECT_EQ(split.mesh.n_hexahedra(), 48);
  EXPECT_EQ(split.mesh.n_nodes(), 4 * 25 + 2);
  const int doubled = grid.nodes_per_level() + grid.surface_index(2, 2);
  EXPECT_NE(split.outer_node[doubled], split.inner_node[doubled]);
  EXPECT_EQ(split.mesh.rest_positions.col(split.outer_node[doubled]),
            split.mesh.rest_positions.col(split.inner_node[doubled]));
  ASSERT_EQ(split.bone_nodes.size(), 1u);
  // No hexahedron stands on bone, and those above the film do not share nodes with those below.
  for (int h = 0; h < split.mesh.n_hexahedra(); ++h) {
    for (const int node : split.mesh.hexahedra[h]) {
      EXPECT_NE(node, split.bone_nodes[0]);
      EXPECT_NE(node, split.mesh.material[h] == 0 ? split.inner_node[doubled] : split.outer_node[doubled]);
    }
  }
  EXPECT_FALSE(split.mesh.stacked[0]);
  EXPECT_TRUE(split.mesh.stacked[16]);
}

}  // namespace
}  // namespace lipofill::coupling
