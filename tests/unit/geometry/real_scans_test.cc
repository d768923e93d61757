// The jaw_angle region on every face at hand, from the file to the hexahedra.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/geometry/face_geometry.h"
#include "core/geometry/surface_cleaning.h"
#include "core/geometry/surface_distance.h"
#include "core/geometry/surface_reader.h"
#include "core/geometry/surface_topology.h"
#include "tests/unit/geometry/jaw_angle_region.h"
#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

using nlohmann::json;

struct Face {
  const char* name;
  const char* folder;
  const char* surface;
  const char* landmarks;
  const char* landmarks_key;
};

void PrintTo(const Face& face, std::ostream* out) {
  *out << face.name;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

Eigen::Vector3d to_vector(const json& xyz) {
  return {xyz[0].get<double>(), xyz[1].get<double>(), xyz[2].get<double>()};
}

ScanRegionSpec make_region(const Face& face) {
  const std::filesystem::path folder = face.folder;
  ScanRegionSpec region;
  auto scan = read_surface(read_file(folder / face.surface), SurfaceFormat::kObj, 1e-3);
  EXPECT_TRUE(scan.ok()) << scan.status();
  if (scan.ok()) region.scan = std::move(*scan);
  const json description = json::parse(read_file(folder / face.landmarks));
  for (const auto& [name, xyz] : description[face.landmarks_key].items())
    region.landmarks[name] = 1e-3 * to_vector(xyz);
  if (description.contains("axes")) {
    const json& axes = description["axes"];
    region.axes = HeadAxes{to_vector(axes["left"]), to_vector(axes["up"]), to_vector(axes["forward"])};
  }
  region.corners = make_jaw_angle_corners();
  return region;
}

class RealScans : public ::testing::TestWithParam<Face> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(std::filesystem::path(GetParam().folder) / GetParam().surface)) {
      GTEST_SKIP() << "no real scans in " << GetParam().folder;
    }
  }
};

double largest_turn_between_neighbours(const LayeredGrid& grid) {
  double smallest_cosine = 1.0;
  const auto normal = [&](int i, int j) {
    const Eigen::Vector3d a = grid.nodes.col(grid.node(0, i, j));
    return Eigen::Vector3d(
               (grid.nodes.col(grid.node(0, i + 1, j)) - a).cross(grid.nodes.col(grid.node(0, i, j + 1)) - a))
        .normalized();
  };
  for (int j = 0; j + 1 < grid.n_eta; ++j) {
    for (int i = 0; i + 1 < grid.n_xi; ++i) {
      smallest_cosine = std::min(smallest_cosine, normal(i, j).dot(normal(i + 1, j)));
      smallest_cosine = std::min(smallest_cosine, normal(i, j).dot(normal(i, j + 1)));
    }
  }
  return std::acos(std::min(1.0, smallest_cosine)) * 57.29578;
}

TEST_P(RealScans, JawAngleRegionBuilds) {
  FaceGeometrySpec spec;
  spec.region = make_region(GetParam());
  spec.n_xi = 40;
  spec.n_eta = 31;
  spec.layers = {{ScalarField::constant(1.8e-3), 1}, {ScalarField::constant(10e-3), 1}};
  const auto geometry = build_face_geometry(spec, nullptr);
  ASSERT_TRUE(geometry.ok()) << geometry.status();
  const double turn = largest_turn_between_neighbours(geometry->grid);
  std::printf("%s: scaled Jacobian %.3f, area %.1f cm2, %zu riders within %.2f mm, largest turn %.1f degrees\n",
              GetParam().name, geometry->grid.min_scaled_jacobian, geometry->skin_area * 1e4, geometry->riders.size(),
              geometry->max_rider_distance * 1e3, turn);
  for (const std::string& remark : geometry->scan_remarks) std::printf("  %s\n", remark.c_str());
  EXPECT_GT(geometry->grid.min_scaled_jacobian, 0.3);
  EXPECT_GT(geometry->skin_area, 35e-4);
  EXPECT_LT(geometry->skin_area, 65e-4);
  EXPECT_GT(geometry->riders.size(), 40u);
  EXPECT_LT(geometry->max_rider_distance, 2.0e-3);
  EXPECT_LT(turn, 25.0);
}

constexpr char kReal[] = LIPOFILL_SHARED_DATA;
constexpr char kSample[] = LIPOFILL_SAMPLE_FACES;

INSTANTIATE_TEST_SUITE_P(
    Faces, RealScans,
    ::testing::Values(Face{"half_face", kSample, "half_face.obj", "half_face.landmarks.json", "landmarks"},
                      Face{"lps_head", kReal, "lps_head.obj", "lps_head.landmarks.json", "landmarks"},
                      Face{"patient_before", kReal, "lps_patient_before.obj", "lps_patient.json", "landmarks_before"},
                      Face{"patient_target", kReal, "lps_patient_target.obj", "lps_patient_target.landmarks.json",
                           "landmarks"},
                      Face{"james", kReal, "james_face.obj", "james_face.landmarks.json", "landmarks"}),
    [](const auto& test) { return std::string(test.param.name); });

/// A real face as it is, and the same thickened inwards by 2 mm, or moved far from the origin.
class ChangedScans : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(std::filesystem::path(kReal) / "lps_patient_target.obj"))
      GTEST_SKIP() << "no real scans in " << kReal;
    region_ =
        make_region({"target", kReal, "lps_patient_target.obj", "lps_patient_target.landmarks.json", "landmarks"});
  }

  static LayeredGrid build(const ScanRegionSpec& region, std::vector<std::string>* remarks = nullptr) {
    FaceGeometrySpec spec;
    spec.region = region;
    spec.n_xi = spec.n_eta = 24;
    spec.layers = {{ScalarField::constant(1.8e-3), 1}};
    const auto geometry = build_face_geometry(spec, nullptr);
    EXPECT_TRUE(geometry.ok()) << geometry.status();
    if (geometry.ok() && remarks != nullptr) *remarks = geometry->scan_remarks;
    return geometry.ok() ? geometry->grid : LayeredGrid{};
  }

  ScanRegionSpec region_;
};

TEST_F(ChangedScans, OneThickenedForPrintGivesTheModelOfItsOuterWall) {
  const LayeredGrid plain = build(region_);
  const SurfaceMesh scan = clean_surface(region_.scan).mesh;
  SurfaceMesh inner = scan;
  inner.points -= 2e-3 * compute_vertex_normals(scan);
  for (auto& triangle : inner.triangles) std::swap(triangle[1], triangle[2]);
  region_.scan = put_together(scan, inner);
  std::vector<std::string> remarks;
  const LayeredGrid thickened = build(region_, &remarks);
  EXPECT_THAT(remarks, ::testing::Contains(::testing::HasSubstr("shell of two walls 2.0 mm apart")));
  ASSERT_EQ(thickened.nodes.cols(), plain.nodes.cols());
  EXPECT_LT((thickened.nodes - plain.nodes).colwise().norm().maxCoeff(), 1e-5);
}

TEST_F(ChangedScans, FarFromTheOriginTheModelIsTheSame) {
  const LayeredGrid plain = build(region_);
  const Eigen::Vector3d far(4e5, -3e5, 1e4);
  region_.scan.points.colwise() += far;
  for (auto& [name, position] : region_.landmarks) position += far;
  const LayeredGrid moved = build(region_);
  ASSERT_EQ(moved.nodes.cols(), plain.nodes.cols());
  EXPECT_LT(((moved.nodes.colwise() - far) - plain.nodes).colwise().norm().maxCoeff(), 1e-7);
}

/// The mouth bag of lps_head lies 20 mm under the cheek; lps_patient_target is the same face
/// without it, at most 0.75 mm away.
class MouthBag : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path folder = kReal;
    if (!std::filesystem::exists(folder / "lps_head.obj")) GTEST_SKIP() << "no real scans in " << kReal;
    region_ = make_region({"lps_head", kReal, "lps_head.obj", "lps_head.landmarks.json", "landmarks"});
    target_ = *read_surface(read_file(folder / "lps_patient_target.obj"), SurfaceFormat::kObj, 1e-3);
  }

  FaceGeometrySpec make_spec() const {
    FaceGeometrySpec spec;
    spec.region = region_;
    spec.n_xi = spec.n_eta = 30;
    spec.layers = {{ScalarField::constant(1.8e-3), 1}};
    return spec;
  }

  ScanRegionSpec region_;
  SurfaceMesh target_;
};

TEST_F(MouthBag, StaysOutOfTheSkinAndItsRiders) {
  const auto geometry = build_face_geometry(make_spec(), nullptr);
  ASSERT_TRUE(geometry.ok()) << geometry.status();
  const auto skin = geometry->grid.nodes.leftCols(geometry->grid.nodes_per_level());
  EXPECT_LT(compute_distance_statistics(compute_signed_distances(skin, target_)).max, 1.5e-3);
  Eigen::Matrix3Xd riders(3, geometry->riders.size());
  for (size_t k = 0; k < geometry->riders.size(); ++k)
    riders.col(k) = geometry->scan.points.col(geometry->riders[k].vertex);
  EXPECT_LT(compute_distance_statistics(compute_signed_distances(riders, target_)).max, 1.0e-3);
}

TEST_F(MouthBag, CornersOnItAreRefused) {
  // The vertex deepest under the cheek: farthest inside the face without the bag.
  const std::vector<double> depth = compute_signed_distances(region_.scan.points, target_);
  const auto deepest = std::min_element(depth.begin(), depth.end());
  ASSERT_LT(*deepest, -0.012);
  region_.corners[1] = Eigen::Vector3d(region_.scan.points.col(deepest - depth.begin()));
  const auto geometry = build_face_geometry(make_spec(), nullptr);
  EXPECT_EQ(geometry.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(geometry.status().message()), ::testing::HasSubstr("corners[1]: lies on an inner surface"));
}

}  // namespace
}  // namespace lipofill::geometry
