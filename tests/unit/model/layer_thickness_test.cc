// Thickness that a layer takes from the face it lies in.

#include "core/model/layer_thickness.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "tests/unit/geometry/test_surfaces.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kRadius = 0.080;
constexpr double kBoneRadius = 0.068;
const Eigen::Vector3d kBoneCentre(0.002, 0.001, -0.002);

Eigen::Vector3d on_sphere(double longitude, double latitude) {
  return kRadius * Eigen::Vector3d(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                                   std::sin(latitude));
}

/// A head that is a sphere, its skull another, not about the same middle: 1.8 mm of skin, and
/// muscle down to the bone.
model::FaceModelSpec make_spherical_head() {
  geometry::ScanRegionSpec region;
  region.scan = geometry::make_sphere(kRadius, 60);
  region.corners = {on_sphere(-0.3, -0.3), on_sphere(0.3, -0.3), on_sphere(0.3, 0.3), on_sphere(-0.3, 0.3)};
  model::FaceModelSpec spec;
  spec.region = region;
  spec.n_xi = spec.n_eta = 16;
  spec.layers = {{"skin", {geometry::ScalarField::constant(1.8e-3), 1}, {1e5, 0.45, 1100.0}},
                 {"muscle", {geometry::ScalarField::constant(0.0), 1}, {2e5, 0.45, 1050.0}}};
  spec.layers[1].down_to_bone = model::DownToBone{};
  spec.bone = geometry::make_sphere(kBoneRadius, 60);
  spec.bone->points.colwise() += kBoneCentre;
  return spec;
}

std::vector<std::string> refused_fields(const model::FaceModelSpec& spec) {
  const auto model = model::build_face_model(spec, nullptr);
  EXPECT_EQ(model.status().code(), absl::StatusCode::kInvalidArgument) << model.status();
  std::vector<std::string> fields;
  for (const FieldViolation& violation : field_violations_of(model.status())) fields.push_back(violation.field);
  return fields;
}

TEST(LayerThickness, TheDeepFaceOfALayerDownToTheBoneLiesOnTheBone) {
  const auto model = model::build_face_model(make_spherical_head(), nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  const geometry::LayeredGrid& grid = (*model)->geometry.grid;
  double largest = 0.0;
  for (int node = 2 * grid.nodes_per_level(); node < 3 * grid.nodes_per_level(); ++node) {
    largest = std::max(largest, std::abs((grid.nodes.col(node) - kBoneCentre).norm() - kBoneRadius));
  }
  printf("deep face from the bone: at most %.4f mm\n", largest * 1e3);
  EXPECT_LT(largest, 0.1e-3);
  ASSERT_TRUE((*model)->bone.has_value());
  EXPECT_EQ((*model)->bone->measured_share, 1.0);
  EXPECT_EQ((*model)->bone->limited_share, 0.0);
  ASSERT_EQ((*model)->thickness.size(), 2u);
  EXPECT_NEAR((*model)->thickness[0].mean, 1.8e-3, 1e-15);
  EXPECT_NEAR((*model)->thickness[1].mean, (*model)->bone->depth.mean - 1.8e-3, 1e-12);
  EXPECT_GT((*model)->thickness[1].max, (*model)->thickness[1].min + 0.5e-3);
  EXPECT_NEAR((*model)->layers[1].geometry.thickness.maximum(), (*model)->thickness[1].max, 1e-15);
}

TEST(LayerThickness, BoneDeeperThanTheBoundEndsTheLayerAboveIt) {
  model::FaceModelSpec spec = make_spherical_head();
  spec.layers[1].down_to_bone->max_thickness = 8e-3;
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ((*model)->thickness[1].max, 8e-3);
  EXPECT_LT((*model)->thickness[1].min, 8e-3);
  EXPECT_GT((*model)->bone->limited_share, 0.0);
  EXPECT_LT((*model)->bone->limited_share, 1.0);
}

TEST(LayerThickness, LayersThatLeaveTooLittleAreRefusedWithPlaceAndFigures) {
  model::FaceModelSpec spec = make_spherical_head();
  spec.layers[0].geometry.thickness = geometry::ScalarField::constant(9.5e-3);
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_THAT(refused_fields(spec), ElementsAre("layers[1].down_to_bone"));
  EXPECT_THAT(std::string(model.status().message()), HasSubstr("the other layers take 9.50 mm"));
}

TEST(LayerThickness, WhatCannotBeAskedForIsRefusedBeforeTheScanIsReadOver) {
  model::FaceModelSpec no_bone = make_spherical_head();
  no_bone.bone.reset();
  EXPECT_THAT(refused_fields(no_bone), ElementsAre("layers[1].down_to_bone"));

  model::FaceModelSpec unused = make_spherical_head();
  unused.layers[1].down_to_bone.reset();
  unused.layers[1].geometry.thickness = geometry::ScalarField::constant(5e-3);
  EXPECT_THAT(refused_fields(unused), ElementsAre("scan_region.bone_scan"));

  model::FaceModelSpec twice = make_spherical_head();
  twice.layers[0].down_to_bone = model::DownToBone{};
  EXPECT_THAT(refused_fields(twice), ElementsAre("layers[1].down_to_bone"));

  model::FaceModelSpec bounds = make_spherical_head();
  bounds.layers[1].down_to_bone = model::DownToBone{0.1e-3, 0.05e-3, -1e-3};
  EXPECT_THAT(refused_fields(bounds),
              ElementsAre("layers[1].down_to_bone.min_thickness_mm", "layers[1].down_to_bone.max_thickness_mm",
                          "layers[1].down_to_bone.smoothing_mm"));

  model::FaceModelSpec regional = make_spherical_head();
  regional.layers[0].regional_thickness = true;
  EXPECT_THAT(refused_fields(regional), ElementsAre("layers[0].kind"));
  regional.layers[0].kind = anatomy::TissueKind::kSkin;
  EXPECT_THAT(refused_fields(regional), ElementsAre("layers[0].regional_thickness")) << "there are no landmarks";
  regional.layers[1].regional_thickness = true;
  regional.layers[1].kind = anatomy::TissueKind::kMuscle;
  EXPECT_THAT(refused_fields(regional), ElementsAre("layers[1].regional_thickness"));
}

TEST(LayerThickness, ASquareHasNeitherBoneNorRegions) {
  model::FaceModelSpec spec = make_small_model_spec();
  spec.layers[0].kind = anatomy::TissueKind::kSkin;
  spec.layers[0].regional_thickness = true;
  spec.layers[1].down_to_bone = model::DownToBone{};
  EXPECT_THAT(refused_fields(spec), ElementsAre("layers[0].regional_thickness", "layers[1].down_to_bone"));
}

/// The head of above with 7 mm of muscle measured on the half where xi <= 0.5, and nothing beyond.
model::FaceModelSpec make_half_measured_head() {
  model::FaceModelSpec spec = make_spherical_head();
  spec.bone.reset();
  spec.layers[1].down_to_bone.reset();
  spec.layers[1].kind = anatomy::TissueKind::kMuscle;
  geometry::ScalarField& field = spec.layers[1].geometry.thickness;
  field = {17, 17, std::vector<double>(17 * 17, 7e-3)};
  for (size_t k = 0; k < field.values.size(); ++k) {
    if (k % 17 > 8) field.values[k] = std::nan("");
  }
  return spec;
}

TEST(LayerThickness, WhatWasNotMeasuredTakesTheFigureOfItsKindAndARemark) {
  const auto model = model::build_face_model(make_half_measured_head(), nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  const geometry::ScalarField& found = (*model)->layers[1].geometry.thickness;
  ASSERT_EQ(found.n_xi, 17);
  EXPECT_DOUBLE_EQ(found.values[8], 7e-3) << "measured";
  EXPECT_GT(found.values[9], 7e-3);
  EXPECT_GT(found.values[16], 9.5e-3) << "24 mm from what was measured";
  EXPECT_LT(found.values[16], 10e-3);
  EXPECT_THAT((*model)->geometry.cautions,
              Contains(HasSubstr("muscle is measured at 52.9 % of the region; at the other 47.1 % the figure of its "
                                 "kind stands, 9.")));
}

TEST(LayerThickness, GapsNeedAKindAndSomethingMeasured) {
  model::FaceModelSpec unknown = make_half_measured_head();
  unknown.layers[1].kind.reset();
  EXPECT_THAT(refused_fields(unknown), ElementsAre("layers[1].kind"));
  model::FaceModelSpec nothing = make_half_measured_head();
  for (double& value : nothing.layers[1].geometry.thickness.values) value = std::nan("");
  EXPECT_THAT(refused_fields(nothing), ElementsAre("layers[1].thickness_mm.samples"));
  model::FaceModelSpec thick = make_half_measured_head();
  thick.layers[1].geometry.thickness.values[0] = 0.2;
  EXPECT_THAT(refused_fields(thick), ElementsAre("layers[1].thickness_mm")) << "what is known keeps its bounds";
}

TEST(LayerThickness, PlainLayersAreLaidAsTheirFieldsSay) {
  model::FaceModelSpec spec = make_small_model_spec();
  spec.layers[1].geometry.thickness = {2, 1, {6e-3, 8e-3}};
  const auto model = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_FALSE((*model)->bone.has_value());
  EXPECT_DOUBLE_EQ((*model)->thickness[1].min, 6e-3);
  EXPECT_NEAR((*model)->thickness[1].mean, 7e-3, 1e-15);
  EXPECT_DOUBLE_EQ((*model)->thickness[1].max, 8e-3);
  geometry::FaceGeometrySpec whole;
  whole.region = spec.region;
  whole.n_xi = whole.n_eta = 12;
  for (const model::TissueLayerSpec& layer : spec.layers) whole.layers.push_back(layer.geometry);
  const auto geometry = geometry::build_face_geometry(whole, nullptr);
  ASSERT_TRUE(geometry.ok());
  EXPECT_EQ((*model)->geometry.grid.nodes, geometry->grid.nodes);
}

TEST(FaceModel, TheLawOfALayerIsPartOfTheContentHash) {
  model::FaceModelSpec spec = make_small_model_spec();
  const std::string without = (*model::build_face_model(spec, nullptr))->content_hash;
  spec.layers[0].material.law = solid::TissueLaw::kNeoHookean;
  const std::string outer = (*model::build_face_model(spec, nullptr))->content_hash;
  EXPECT_NE(outer, without);
  spec.layers[1].material.law = solid::TissueLaw::kNeoHookean;
  EXPECT_NE((*model::build_face_model(spec, nullptr))->content_hash, outer);
}

TEST(FaceModel, PrestressIsBoundedAndPartOfTheContentHash) {
  model::FaceModelSpec spec = make_small_model_spec();
  const std::string without = (*model::build_face_model(spec, nullptr))->content_hash;
  spec.layers[0].material.prestress = 20e3;
  const auto tense = model::build_face_model(spec, nullptr);
  ASSERT_TRUE(tense.ok()) << tense.status();
  EXPECT_NE((*tense)->content_hash, without);
  spec.layers[0].material.prestress = 21e3;
  EXPECT_NE((*model::build_face_model(spec, nullptr))->content_hash, (*tense)->content_hash);
  for (const double wrong : {-1.0, 1.001e6, std::nan("")}) {
    spec.layers[0].material.prestress = wrong;
    EXPECT_THAT(refused_fields(spec), Contains("layers[0].prestress_kpa"));
  }
}

TEST(FaceModel, BuildingStopsWhenAsked) {
  const model::FaceModelSpec spec = make_spherical_head();
  const auto never = model::build_face_model(spec, [](double, const char*) { return false; });
  EXPECT_EQ(never.status().code(), absl::StatusCode::kCancelled);
  const auto late = model::build_face_model(spec, [](double fraction, const char*) { return fraction < 1.0; });
  EXPECT_EQ(late.status().code(), absl::StatusCode::kCancelled);
  double last = 0.0;
  const auto done = model::build_face_model(spec, [&last](double fraction, const char*) {
    EXPECT_GE(fraction, last);
    last = fraction;
    return true;
  });
  EXPECT_TRUE(done.ok());
  EXPECT_EQ(last, 1.0);
}

}  // namespace
}  // namespace lipofill::simulation
