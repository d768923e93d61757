// The steps from outer skin to hexahedra, each against a closed form.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "core/geometry/conformal_map.h"
#include "core/geometry/extrusion.h"
#include "core/geometry/hex_quality.h"
#include "core/geometry/outer_skin.h"
#include "core/geometry/planar_locator.h"
#include "core/geometry/surface_chart.h"
#include "core/geometry/surface_cleaning.h"
#include "core/geometry/surface_locator.h"
#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

using ::testing::HasSubstr;

TEST(RayTree, AgreesWithEveryTriangleTriedInTurn) {
  const SurfaceMesh mesh = put_together(make_sphere(0.05, 6), make_sphere_cap(0.09, 2.0, 7));
  const RayTree tree(mesh);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  int blocked = 0;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d from = 0.06 * draw();
    const Eigen::Vector3d direction =
        k % 10 == 0 ? Eigen::Vector3d(Eigen::Vector3d::UnitY()) : draw().normalized().eval();
    bool expected = false;
    for (const auto& [a, b, c] : mesh.triangles) {
      Eigen::Matrix3d system;
      system << mesh.points.col(b) - mesh.points.col(a), mesh.points.col(c) - mesh.points.col(a), -direction;
      const Eigen::Vector3d uvt = system.partialPivLu().solve(from - mesh.points.col(a));
      expected = expected || (uvt[0] >= 0 && uvt[1] >= 0 && uvt[0] + uvt[1] <= 1 && uvt[2] > 0);
    }
    EXPECT_EQ(tree.is_blocked(from, direction), expected) << k;
    blocked += expected;
  }
  EXPECT_GT(blocked, 400);
  EXPECT_LT(blocked, 1900);
}

std::vector<bool> find_all_outer_skin(const SurfaceMesh& mesh) {
  std::vector<int> all(mesh.triangles.size());
  for (size_t t = 0; t < all.size(); ++t) all[t] = static_cast<int>(t);
  return find_outer_skin(mesh, find_neighbours(mesh).across, RayTree(mesh), all);
}

TEST(OuterSkin, LeavesOutAShellUnderTheSkinAndABagInIt) {
  const SurfaceMesh skin = clean_surface(make_sphere(0.080, 12)).mesh;
  const SurfaceMesh shell = clean_surface(make_sphere(0.070, 12)).mesh;
  const SurfaceMesh bag = turn_over(clean_surface(make_sphere(0.030, 12)).mesh);  // its outside is the hollow within
  const SurfaceMesh all = put_together(put_together(skin, shell), bag);
  const std::vector<bool> outer = find_all_outer_skin(all);
  for (int t = 0; t < all.n_triangles(); ++t) EXPECT_EQ(outer[t], t < skin.n_triangles()) << t;
}

TEST(OuterSkin, KnowsInsideFromOutside) {
  const SurfaceMesh cap = make_sphere_cap(0.08, 1.8, 12);
  const SurfaceMesh with_inner_shell = put_together(make_sphere_cap(0.05, 1.8, 12), cap);
  for (const SurfaceMesh& mesh : {cap, with_inner_shell, make_sphere(0.08, 6)}) {
    EXPECT_FALSE(is_inside_out(mesh));
    EXPECT_TRUE(is_inside_out(turn_over(mesh)));
  }
}

/// Largest departure from a similarity over the triangles: 0 for a conformal map,
/// (s1 - s2) / (s1 + s2) of the singular values.
double largest_distortion(const SurfaceMesh& mesh, const Eigen::Matrix2Xd& flat) {
  double largest = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d e1 = mesh.points.col(b) - mesh.points.col(a);
    const Eigen::Vector3d e2 = mesh.points.col(c) - mesh.points.col(a);
    const Eigen::Vector3d x = e1.normalized();
    const Eigen::Vector3d y = e1.cross(e2).normalized().cross(x);
    Eigen::Matrix2d from;
    from << e1.dot(x), e2.dot(x), 0.0, e2.dot(y);
    Eigen::Matrix2d to;
    to << flat.col(b) - flat.col(a), flat.col(c) - flat.col(a);
    const Eigen::Matrix2d gradient = to * from.inverse();
    EXPECT_GT(gradient.determinant(), 0.0);
    const Eigen::Vector2d s = gradient.jacobiSvd().singularValues();
    largest = std::max(largest, (s[0] - s[1]) / (s[0] + s[1]));
  }
  return largest;
}

TEST(ConformalMap, UnrollsACylinderExactly) {
  const SurfaceMesh cylinder = make_sheet(
      16, 9, [](double u, double v) { return Eigen::Vector3d(0.05 * std::cos(u), 0.05 * std::sin(u), 0.04 * v); });
  const auto flat = compute_conformal_map(cylinder, 0, cylinder.n_vertices() - 1);
  ASSERT_TRUE(flat.ok());
  EXPECT_LT(largest_distortion(cylinder, *flat), 1e-6);
}

TEST(ConformalMap, OfASphereBecomesConformalAsTheMeshIsRefined) {
  std::vector<double> distortion;
  for (const int n : {8, 16, 32}) {
    const SurfaceMesh cap = make_sphere_cap(0.08, 1.2, n);
    const auto flat = compute_conformal_map(cap, 0, cap.n_vertices() - 1);
    ASSERT_TRUE(flat.ok());
    distortion.push_back(largest_distortion(cap, *flat));
  }
  EXPECT_LT(distortion.back(), 0.02);
  EXPECT_LT(distortion[1], 0.7 * distortion[0]);
  EXPECT_LT(distortion[2], 0.7 * distortion[1]);
}

TEST(HarmonicMap, IsFreeOfFoldsAlsoOverHoles) {
  SurfaceMesh cap = make_sphere_cap(0.08, 2.0, 14);
  cap.triangles.erase(cap.triangles.begin() + 180, cap.triangles.begin() + 190);
  const auto flat = compute_harmonic_map(cap);
  ASSERT_TRUE(flat.ok()) << flat.status();
  for (const auto& [a, b, c] : cap.triangles) {
    EXPECT_GT(compute_signed_area(flat->col(a), flat->col(b), flat->col(c)), 0.0);
  }
}

TEST(GridSmoothing, KeepsAPlaneAndFadesTheShortest) {
  const int n = 20;
  const SurfaceMesh plane =
      make_sheet(n, n, [](double u, double v) { return Eigen::Vector3d(0.04 * u, 0.04 * v, 0.01 * u); });
  Eigen::Matrix3Xd points = plane.points;
  const Eigen::Vector2d spacing = compute_mean_spacing(n, n, points);
  smooth_over_grid(n, n, spacing, 0.004, points);
  EXPECT_LT((points - plane.points).cwiseAbs().maxCoeff(), 1e-12);
  for (int k = 0; k < points.cols(); ++k) points(2, k) += (k % 2 ? 1e-4 : -1e-4);
  smooth_over_grid(n, n, spacing, 0.004, points);
  EXPECT_LT((points - plane.points).row(2).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(GridNormals, OfASphereAreRadialToSecondOrder) {
  std::vector<double> error;
  for (const int n : {10, 20}) {
    const SurfaceMesh cap = make_sphere_cap(0.05, 1.0, n);
    const Eigen::Matrix3Xd normals = compute_grid_normals(n, n, cap.points);
    error.push_back((normals - cap.points / 0.05).colwise().norm().maxCoeff());
  }
  EXPECT_LT(error[1], 2e-3);
  EXPECT_GT(std::log2(error[0] / error[1]), 1.7);
}

double compute_volume(const LayeredGrid& grid) {
  const double near = 0.5 - 0.5 / std::sqrt(3.0);
  double volume = 0.0;
  for (int level = 0; level + 1 < grid.n_levels(); ++level) {
    for (int j = 0; j < grid.n_eta; ++j) {
      for (int i = 0; i < grid.n_xi; ++i) {
        for (int point = 0; point < 8; ++point) {
          const Eigen::Vector3d at(point & 1 ? near : 1 - near, point & 2 ? near : 1 - near,
                                   point & 4 ? near : 1 - near);
          Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
          for (int a = 0; a < 8; ++a) {
            const Eigen::Vector3d x = grid.nodes.col(grid.node(level + 1 - (a >> 2), i + (a & 1), j + (a >> 1 & 1)));
            for (int d = 0; d < 3; ++d) {
              double weight = a >> d & 1 ? 1.0 : -1.0;
              for (int c = 0; c < 3; ++c) weight *= c == d ? 1.0 : (a >> c & 1 ? at[c] : 1.0 - at[c]);
              jacobian.col(d) += weight * x;
            }
          }
          volume += jacobian.determinant() / 8.0;
        }
      }
    }
  }
  return volume;
}

TEST(Extrusion, OfASphereHasTheVolumeOfItsShellToSecondOrder) {
  const double radius = 0.06;
  const double width = 0.8;
  const std::vector<LayerGeometry> layers = {{ScalarField::constant(0.002), 1}, {ScalarField::constant(0.010), 3}};
  const double solid_angle = width * 2.0 * std::sin(width / 2);
  const double exact = solid_angle * (std::pow(radius, 3) - std::pow(radius - 0.012, 3)) / 3.0;
  std::vector<double> error;
  for (const int n : {8, 16, 32}) {
    const auto grid = extrude_layers(make_sphere_cap(radius, width, n).points, n, n, layers);
    ASSERT_TRUE(grid.ok()) << grid.status();
    EXPECT_GT(grid->min_scaled_jacobian, 0.9);
    EXPECT_EQ(grid->n_levels(), 5);
    error.push_back(std::abs(compute_volume(*grid) / exact - 1.0));
  }
  EXPECT_LT(error.back(), 2e-3);
  EXPECT_GT(std::log2(error[0] / error[1]), 1.7);
  EXPECT_GT(std::log2(error[1] / error[2]), 1.7);
}

TEST(Extrusion, FollowsAThicknessField) {
  const int n = 10;
  const SurfaceMesh plate = make_sheet(n, n, [](double u, double v) { return Eigen::Vector3d(0.1 * u, 0.1 * v, 0.0); });
  const auto grid = extrude_layers(plate.points, n, n, {{ScalarField{2, 1, {0.002, 0.006}}, 2}});
  ASSERT_TRUE(grid.ok());
  EXPECT_NEAR(grid->nodes(2, grid->node(2, 0, 3)), -0.002, 1e-12);
  EXPECT_NEAR(grid->nodes(2, grid->node(1, 5, 3)), -0.002, 1e-12);
  EXPECT_NEAR(grid->nodes(2, grid->node(2, 10, 3)), -0.006, 1e-12);
}

TEST(Extrusion, RefusesLayersThickerThanTheCurvatureAllows) {
  const int n = 16;
  const auto grid = extrude_layers(make_sphere_cap(0.010, 1.6, n).points, n, n,
                                   {{ScalarField::constant(0.002), 1}, {ScalarField::constant(0.030), 1}});
  ASSERT_FALSE(grid.ok());
  EXPECT_EQ(grid.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(grid.status().message()), HasSubstr("layers[1] folds"));
  EXPECT_THAT(std::string(grid.status().message()), HasSubstr(" mm"));
}

TEST(Extrusion, TellsUnderWhichPlacesOfTheSkinLayersFold) {
  const int n = 16;
  const SurfaceMesh cap = make_sphere_cap(0.010, 1.6, n);
  std::vector<Eigen::Vector3d> folded;
  ASSERT_TRUE(extrude_layers(cap.points, n, n, {{ScalarField::constant(0.0005), 1}}, &folded).ok());
  EXPECT_TRUE(folded.empty());
  ASSERT_FALSE(extrude_layers(cap.points, n, n, {{ScalarField::constant(0.030), 1}}, &folded).ok());
  ASSERT_FALSE(folded.empty());
  for (const Eigen::Vector3d& place : folded) {
    EXPECT_LT((cap.points.colwise() - place).colwise().norm().minCoeff(), 1.5e-3) << "it lies on the skin";
  }
}

TEST(HexQuality, KnowsACuboidASkewOneAndAFoldedOne) {
  Eigen::Matrix<double, 3, 8> x;
  x << 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 2, 2, 0, 0, 2, 2, 0, 0, 0, 0, 3, 3, 3, 3;
  EXPECT_NEAR(compute_scaled_jacobian(x), 1.0, 1e-12);
  Eigen::Matrix<double, 3, 8> sheared = x;
  sheared.row(0) += x.row(2);  // 3 up, 3 along: the cosine of 45 degrees
  EXPECT_NEAR(compute_scaled_jacobian(sheared), std::sqrt(0.5), 1e-12);
  x.rightCols<4>().row(2).setConstant(-3.0);
  EXPECT_NEAR(compute_scaled_jacobian(x), -1.0, 1e-12);
}

}  // namespace
}  // namespace lipofill::geometry
