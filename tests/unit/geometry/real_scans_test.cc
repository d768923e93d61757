// The jaw_angle region on every face at hand, from the file to the hexahedra.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/geometry/face_geometry.h"
#include "core/geometry/surface_reader.h"
#include "tests/unit/geometry/jaw_angle_region.h"

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

}  // namespace
}  // namespace lipofill::geometry
