// What lies beneath the tissue of a face: bone, or springs where there is none.

#include <gmock/gmock.h>

#include "core/anatomy/base_give.h"
#include "core/model/face_model.h"
#include "tests/unit/anatomy/faces.h"
#include "tests/unit/geometry/test_surfaces.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

model::FaceModelSpec make_cheek() {
  model::FaceModelSpec spec = make_small_model_spec();
  geometry::ScanRegionSpec region = anatomy::read_face(LIPOFILL_SAMPLE_FACES, "half_face");
  region.corners = anatomy::make_half_face_corners();
  spec.region = region;
  spec.n_xi = spec.n_eta = 24;
  spec.base = {model::SupportKind::kByRegion, anatomy::kSoftBaseStiffness};
  return spec;
}

std::vector<std::string> refused(const model::FaceModelSpec& spec) {
  std::vector<std::string> texts;
  const auto model = model::build_face_model(spec, nullptr);
  EXPECT_FALSE(model.ok());
  for (const FieldViolation& violation : field_violations_of(model.status())) {
    texts.push_back(violation.field + " " + violation.description);
  }
  return texts;
}

TEST(FaceBase, GivesByTheLandmarksAndSaysHowMuch) {
  const auto model = model::build_face_model(make_cheek(), nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  ASSERT_EQ((*model)->base_give.size(), (*model)->geometry.grid.nodes_per_level());
  EXPECT_EQ((*model)->base_give.minCoeff(), 0.0);
  EXPECT_EQ((*model)->base_give.maxCoeff(), 1.0);
  EXPECT_THAT((*model)->geometry.cautions,
              Contains(::testing::AllOf(HasSubstr("by the landmarks"), HasSubstr("1.00 kPa/mm, an assumed figure"))));
}

TEST(FaceBase, AGivenStiffnessIsNotCalledAssumed) {
  model::FaceModelSpec spec = make_cheek();
  spec.base.stiffness = 0.4e6;
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_THAT((*model)->geometry.cautions, Contains(HasSubstr("springs of 0.40 kPa/mm.")));
  EXPECT_NE((*model)->content_hash, (*model::build_face_model(make_cheek(), nullptr))->content_hash);
}

TEST(FaceBase, IsBoneWhereNoLandmarksShowOtherwise) {
  model::FaceModelSpec spec = make_cheek();
  auto& region = std::get<geometry::ScanRegionSpec>(spec.region);
  const auto with_landmarks = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(with_landmarks.ok());
  const geometry::LayeredGrid& grid = (*with_landmarks)->geometry.grid;
  const int n = grid.n_xi;
  region.corners = {Eigen::Vector3d(grid.nodes.col(grid.surface_index(0, 0))),
                    Eigen::Vector3d(grid.nodes.col(grid.surface_index(n, 0))),
                    Eigen::Vector3d(grid.nodes.col(grid.surface_index(n, n))),
                    Eigen::Vector3d(grid.nodes.col(grid.surface_index(0, n)))};
  region.landmarks.clear();
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ((*model)->base.kind, model::SupportKind::kClamped);
  EXPECT_THAT((*model)->geometry.cautions, Contains(HasSubstr("Bone is assumed under the whole region")));
}

TEST(FaceBase, GivesWhereTheScanOfTheBoneShowsNone) {
  constexpr double kRadius = 0.080;
  const auto on_sphere = [&](double longitude, double latitude) -> Eigen::Vector3d {
    return kRadius * Eigen::Vector3d(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                                     std::sin(latitude));
  };
  model::FaceModelSpec spec = make_small_model_spec();
  geometry::ScanRegionSpec region;
  region.scan = geometry::make_sphere(kRadius, 60);
  region.corners = {on_sphere(-0.3, -0.3), on_sphere(0.3, -0.3), on_sphere(0.3, 0.3), on_sphere(-0.3, 0.3)};
  spec.region = region;
  spec.n_xi = spec.n_eta = 16;
  spec.layers[1].down_to_bone = model::DownToBone{1e-3, 8e-3, 2e-3};
  // The skull lies 8 mm further to the left, so that the layer ends above it on the other side.
  spec.bone = geometry::make_sphere(0.070, 60);
  spec.bone->points.row(1).array() += 8e-3;
  spec.base = {model::SupportKind::kByRegion, 2e6};
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  const geometry::LayeredGrid& grid = (*model)->geometry.grid;
  EXPECT_GT((*model)->base_give[grid.surface_index(1, 8)], 0.9) << "the bone lies too deep";
  EXPECT_LT((*model)->base_give[grid.surface_index(15, 8)], 0.1) << "the layer ends on bone";
  EXPECT_THAT((*model)->geometry.cautions, Contains(HasSubstr("by the scan of the bone")));
}

TEST(FaceBase, IsAskedForOfAFaceAndOfItsBaseAlone) {
  model::FaceModelSpec square = make_small_model_spec();
  square.base = {model::SupportKind::kByRegion, 1e6};
  EXPECT_THAT(refused(square), Contains(HasSubstr("base.kind is BY_REGION, which needs a scan_region")));
  model::FaceModelSpec rim = make_cheek();
  rim.rim = {model::SupportKind::kByRegion, 1e6};
  EXPECT_THAT(refused(rim), Contains(HasSubstr("rim.kind is BY_REGION, which only a base can be")));
  model::FaceModelSpec soft = make_cheek();
  soft.base.stiffness = 0.0;
  EXPECT_THAT(refused(soft), Contains(HasSubstr("base.stiffness_kpa_per_mm")));
}

}  // namespace
}  // namespace lipofill::simulation
