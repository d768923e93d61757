#include "core/geometry/outer_wall.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/geometry/surface_cleaning.h"
#include "core/geometry/surface_reader.h"
#include "core/geometry/surface_topology.h"
#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

enum class Rim { kOpen, kFlat, kRound };

/// A mask: an ellipsoid's front with a nose, thickened inwards, its walls joined at the rim or not.
SurfaceMesh make_mask(double thickness, Rim rim, int n = 40) {
  const auto front = [](double u, double v) {
    const double x = 2.0 * u - 1.0;
    const double y = 2.0 * v - 1.0;
    const double nose = 0.02 * std::exp(-30.0 * (x * x + y * y));
    return Eigen::Vector3d(0.065 * x, 0.09 * y, 0.07 * std::cos(1.2 * x) * std::cos(0.8 * y) + nose);
  };
  SurfaceMesh outer = make_sheet(n, n, front);
  const Eigen::Matrix3Xd normals = compute_vertex_normals(outer);
  SurfaceMesh inner = turn_over(outer);
  inner.points = outer.points - thickness * normals;
  const int n_one = outer.n_vertices();
  SurfaceMesh mask = put_together(outer, inner);
  if (rim == Rim::kOpen) return mask;
  const auto loop = trace_boundary_loops(outer, find_neighbours(outer).across).front();
  constexpr int kSteps = 8;
  const int steps = rim == Rim::kFlat ? 1 : kSteps;
  std::vector<std::vector<int>> rows{loop};
  const Eigen::Vector3d centre = outer.points.rowwise().mean();
  for (int s = 1; s < steps; ++s) {
    std::vector<int> row;
    for (const int v : loop) {
      const Eigen::Vector3d normal = normals.col(v);
      Eigen::Vector3d out = outer.points.col(v) - centre;
      out = (out - out.dot(normal) * normal).normalized();
      const double angle = M_PI * s / steps;
      mask.points.conservativeResize(3, mask.points.cols() + 1);
      for (int c = 0; c < 3; ++c) {
        const double off_middle = std::cos(angle) * normal[c] + std::sin(angle) * out[c] - normal[c];
        mask.points(c, mask.points.cols() - 1) = outer.points(c, v) + 0.5 * thickness * off_middle;
      }
      row.push_back(mask.n_vertices() - 1);
    }
    rows.push_back(row);
  }
  rows.emplace_back();
  for (const int v : loop) rows.back().push_back(v + n_one);
  for (size_t r = 0; r + 1 < rows.size(); ++r) {
    for (size_t k = 0; k < loop.size(); ++k) {
      const size_t next = (k + 1) % loop.size();
      mask.triangles.push_back({rows[r][next], rows[r][k], rows[r + 1][k]});
      mask.triangles.push_back({rows[r][next], rows[r + 1][k], rows[r + 1][next]});
    }
  }
  return mask;
}

void expect_outer_wall(const SurfaceMesh& mask, double thickness, int n = 40) {
  const auto shell = find_shell(mask);
  ASSERT_TRUE(shell.has_value());
  EXPECT_NEAR(shell->thickness, thickness, 0.1 * thickness);
  const int n_wall = 2 * n * n;
  size_t kept_of_outer = 0;
  size_t kept_of_inner = 0;
  for (int t = 0; t < 2 * n_wall; ++t) {
    if (shell->is_outer[static_cast<size_t>(t)]) ++(t < n_wall ? kept_of_outer : kept_of_inner);
  }
  EXPECT_GE(kept_of_outer, 0.97 * n_wall);
  EXPECT_LE(kept_of_inner, 0.01 * n_wall);
}

TEST(OuterWall, IsFoundWhateverTheThicknessAndTheRim) {
  for (const double thickness : {0.5e-3, 1e-3, 2e-3, 4e-3}) {
    for (const Rim rim : {Rim::kOpen, Rim::kFlat, Rim::kRound}) {
      SCOPED_TRACE(testing::Message() << thickness * 1e3 << " mm, rim " << static_cast<int>(rim));
      expect_outer_wall(make_mask(thickness, rim), thickness);
    }
  }
}

TEST(OuterWall, IsTheSameTurnedMovedAndInsideOut) {
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.4).normalized().toRotationMatrix();
  SurfaceMesh mask = make_mask(2e-3, Rim::kFlat);
  mask.points = (turn * mask.points).colwise() + Eigen::Vector3d(5e5, -4e5, 3e5);
  expect_outer_wall(mask, 2e-3);
  expect_outer_wall(turn_over(mask), 2e-3);
  SurfaceMesh both_outwards = make_mask(2e-3, Rim::kOpen);
  for (size_t t = both_outwards.triangles.size() / 2; t < both_outwards.triangles.size(); ++t)
    std::swap(both_outwards.triangles[t][1], both_outwards.triangles[t][2]);
  expect_outer_wall(both_outwards, 2e-3);
}

TEST(OuterWall, OfAHollowBodyWithAnOpening) {
  SurfaceMesh outer = clean_surface(make_sphere(0.08, 16)).mesh;
  SurfaceMesh inner = turn_over(outer);
  inner.points *= 0.96;
  const auto is_at_neck = [](const SurfaceMesh& mesh) {
    return [&mesh](const std::array<int, 3>& t) { return mesh.points(1, t[0]) < -0.06; };
  };
  std::erase_if(outer.triangles, is_at_neck(outer));
  std::erase_if(inner.triangles, is_at_neck(inner));
  const CleanedSurface cleaned = clean_surface(put_together(outer, inner));
  EXPECT_EQ(cleaned.mesh.triangles.size(), outer.triangles.size());
  EXPECT_NEAR(cleaned.mesh.points.colwise().norm().minCoeff(), 0.08, 1e-6);
  EXPECT_THAT(cleaned.remarks, Contains(HasSubstr("shell of two walls 3.2 mm apart")));
}

TEST(OuterWall, IsNotLookedForInSingleWallsAndSolids) {
  EXPECT_FALSE(find_shell(make_sphere(0.08, 12)).has_value());
  EXPECT_FALSE(find_shell(make_sphere_cap(0.08, 2.0, 20)).has_value());
  EXPECT_FALSE(find_shell(put_together(make_sphere(0.08, 12), make_sphere(0.05, 12))).has_value());
}

SurfaceMesh read_obj(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  return *read_surface(bytes.str(), SurfaceFormat::kObj, 1e-3);
}

TEST(OuterWall, LeavesRealFacesAlone) {
  EXPECT_FALSE(find_shell(read_obj(std::filesystem::path(LIPOFILL_SAMPLE_FACES) / "half_face.obj")).has_value());
  const std::filesystem::path shared = LIPOFILL_SHARED_DATA;
  for (const char* file : {"lps_head.obj", "lps_patient_before.obj", "lps_patient_target.obj", "james_face.obj"}) {
    if (!std::filesystem::exists(shared / file)) continue;
    EXPECT_FALSE(find_shell(clean_surface(read_obj(shared / file)).mesh).has_value()) << file;
  }
}

}  // namespace
}  // namespace lipofill::geometry
