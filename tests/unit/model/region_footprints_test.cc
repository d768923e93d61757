// A model that goes around its zones, on the face shipped with the project and on faces made of it:
// stretched, mirrored, cut off and made rough.

#include "core/model/region_footprints.h"

#include <gmock/gmock.h>

#include <random>

#include "core/anatomy/regions.h"
#include "core/base/field_violations.h"
#include "tests/unit/anatomy/faces.h"

namespace lipofill::model {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

geometry::ScanRegionSpec sample_face() {
  return anatomy::read_face(LIPOFILL_SAMPLE_FACES, "half_face");
}

FaceModelSpec make_spec(geometry::ScanRegionSpec face, std::vector<std::string> regions) {
  FaceModelSpec spec;
  spec.region = std::move(face);
  spec.n_xi = spec.n_eta = 20;
  const solid::ElasticMaterial skin{90e3, 0.48, 1100.0};
  spec.layers = {{"skin", {geometry::ScalarField::constant(1.8e-3), 1}, skin},
                 {"muscle", {geometry::ScalarField::constant(8e-3), 1}, skin}};
  spec.around = AroundSpec{std::move(regions), {}};
  return spec;
}

/// Stretched along the axes of the scan.
geometry::ScanRegionSpec stretch(geometry::ScanRegionSpec face, const Eigen::Vector3d& factors) {
  face.scan.points = factors.asDiagonal() * face.scan.points;
  for (auto& [name, position] : face.landmarks) position = factors.cwiseProduct(position);
  return face;
}

/// The mirror image: left is right.
geometry::ScanRegionSpec mirror(geometry::ScanRegionSpec face) {
  face.scan.points.row(0) *= -1.0;
  for (auto& triangle : face.scan.triangles) std::swap(triangle[1], triangle[2]);
  geometry::Landmarks mirrored;
  for (const auto& [name, position] : face.landmarks) {
    std::string other = name;
    if (name.ends_with("_left")) other = name.substr(0, name.size() - 5) + "_right";
    if (name.ends_with("_right")) other = name.substr(0, name.size() - 6) + "_left";
    mirrored[other] = Eigen::Vector3d(-position.x(), position.y(), position.z());
  }
  face.landmarks = std::move(mirrored);
  return face;
}

/// Without what lies behind a plane across the head [m].
geometry::ScanRegionSpec cut_behind(geometry::ScanRegionSpec face, double z) {
  std::erase_if(face.scan.triangles, [&](const auto& triangle) {
    return std::any_of(triangle.begin(), triangle.end(), [&](int v) { return face.scan.points(2, v) < z; });
  });
  std::erase_if(face.landmarks, [&](const auto& landmark) { return landmark.first.starts_with("tragion"); });
  return face;
}

TEST(Around, EveryRegionOfFacesOfManyShapesBuilds) {
  const std::vector<Eigen::Vector3d> shapes = {
      {1.0, 1.0, 1.0}, {0.9, 1.12, 1.0}, {1.1, 0.92, 1.05}, {1.0, 1.0, 0.88}, {1.15, 1.15, 1.15}};
  for (const Eigen::Vector3d& shape : shapes) {
    const geometry::ScanRegionSpec face = stretch(sample_face(), shape);
    for (const std::string& region : anatomy::region_names()) {
      const auto model = build_face_model(make_spec(face, {region + "_left"}), nullptr);
      EXPECT_TRUE(model.ok()) << region << " of " << shape.transpose() << ": " << model.status();
      if (model.ok()) EXPECT_GT((*model)->geometry.grid.min_scaled_jacobian, 0.1) << region;
    }
  }
}

TEST(Around, TheZoneLiesWithinItsModel) {
  const auto model = build_face_model(make_spec(sample_face(), {"masseter_left", "mandibular_angle_left"}), nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  for (const char* region : {"masseter_left", "mandibular_angle_left"}) {
    const auto placed = anatomy::place_region((*model)->geometry, region);
    EXPECT_TRUE(placed.ok()) << region << placed.status();
  }
}

TEST(Around, AMirroredFaceGivesTheMirroredModel) {
  const auto left = build_face_model(make_spec(sample_face(), {"malar_left"}), nullptr);
  const auto right = build_face_model(make_spec(mirror(sample_face()), {"malar_right"}), nullptr);
  ASSERT_TRUE(left.ok()) << left.status();
  ASSERT_TRUE(right.ok()) << right.status();
  EXPECT_NEAR((*left)->geometry.skin_area, (*right)->geometry.skin_area, 0.02e-4);
}

TEST(Around, UnknownRegionsAndMissingLandmarksAreNamedBeforeAnythingIsBuilt) {
  geometry::ScanRegionSpec face = sample_face();
  face.scan = {};
  face.landmarks.erase("gonion_left");
  const auto footprints = find_footprints(face, {{"elbow_left", "masseter_left", "buccal_left"}, {}});
  EXPECT_EQ(footprints.status().code(), absl::StatusCode::kInvalidArgument);
  const std::string message(footprints.status().message());
  EXPECT_THAT(message, HasSubstr("scan_region.around.regions[0]: is 'elbow_left', must be one of masseter"));
  EXPECT_THAT(message, HasSubstr("scan_region.around.regions[1]: is 'masseter_left', which needs the landmark "
                                 "gonion_left"));
}

TEST(Around, NothingToGoAroundIsRefused) {
  EXPECT_THAT(std::string(find_footprints(sample_face(), {}).status().message()), HasSubstr("names no region"));
}

TEST(Around, ItGoesAroundADiscAsWell) {
  FaceModelSpec spec = make_spec(sample_face(), {});
  spec.around->discs = {{geometry::LandmarkPoint{{{"zygion_left", 0.5}, {"cheilion_left", 0.5}}, 0, 0, 0}, 12e-3}};
  const auto model = build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  // A square of 12 + 12 mm to each side.
  EXPECT_NEAR((*model)->geometry.skin_area * 1e4, 4.8 * 4.8, 3.0);
}

TEST(Around, AScanThatEndsInTheZoneIsRemarkedUponAndThenRefused) {
  const auto some = build_face_model(make_spec(cut_behind(sample_face(), 0.026), {"masseter_left"}), nullptr);
  ASSERT_TRUE(some.ok()) << some.status();
  EXPECT_THAT((*some)->geometry.cautions,
              Contains(HasSubstr("of masseter_left lies on the model: a border of the scan")));
  const auto little = build_face_model(make_spec(cut_behind(sample_face(), 0.044), {"masseter_left"}), nullptr);
  EXPECT_EQ(little.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(little.status().message()), HasSubstr("a border of the scan"));
}

TEST(Around, ANoisyScanIsSaidToBeNoisy) {
  geometry::ScanRegionSpec face = sample_face();
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.8e-3);
  for (int v = 0; v < face.scan.n_vertices(); ++v) face.scan.points.col(v) += noise(random) * Eigen::Vector3d(1, 0, 1);
  const auto model = build_face_model(make_spec(face, {"masseter_left"}), nullptr);
  if (model.ok()) {
    EXPECT_THAT((*model)->geometry.cautions, Contains(HasSubstr("The scan is rough")));
  } else {
    EXPECT_THAT(std::string(model.status().message()), HasSubstr("the scan is noisy"));
  }
}

}  // namespace
}  // namespace lipofill::model
