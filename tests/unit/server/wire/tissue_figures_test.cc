#include "server/wire/tissue_figures.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/message_differencer.h>

#include "core/base/field_violations.h"
#include "server/wire/model_conversion.h"

namespace lipofill::server {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

v1::ModelSpec square_with(const std::string& rest) {
  v1::ModelSpec spec;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      "square { length_xi_mm: 40 length_eta_mm: 30 } n_xi: 8 n_eta: 6 " + rest, &spec));
  return spec;
}

std::vector<std::string> fields_of(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : field_violations_of(status)) fields.push_back(violation.field);
  return fields;
}

TEST(TissueFigures, APresetFillsWhatLayersLeaveOut) {
  const v1::ModelSpec spec = fill_tissue_figures(square_with(R"(
    tissue_preset: ELASTOGRAPHY layers { name: "skin" } layers { name: "fat" kind: SUBCUTANEOUS }
    layers { name: "smas" } layers { name: "muscle" })"));
  const auto& skin = spec.layers(0);
  EXPECT_EQ(skin.thickness_mm().constant(), 1.8);
  EXPECT_EQ(skin.youngs_modulus_kpa(), 100.0);
  EXPECT_EQ(skin.poisson_ratio(), 0.48);
  EXPECT_EQ(skin.density_kg_m3(), 1100.0);
  EXPECT_EQ(spec.layers(1).youngs_modulus_kpa(), 3.0);
  EXPECT_EQ(spec.layers(2).youngs_modulus_kpa(), 50.0);
  EXPECT_EQ(spec.layers(3).youngs_modulus_kpa(), 20.0);
  EXPECT_EQ(spec.layers(3).thickness_mm().constant(), 10.0);
  EXPECT_TRUE(to_face_model_spec(spec).ok());
  v1::ModelSpec twice = fill_tissue_figures(spec);
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(spec, twice));
}

TEST(TissueFigures, WhatALayerSaysItselfStays) {
  const v1::ModelSpec spec = fill_tissue_figures(square_with(R"(
    tissue_preset: PAPER
    layers { name: "skin" thickness_mm { constant: 4 } youngs_modulus_kpa: 0.5 poisson_ratio: 0 density_kg_m3: 7 }
    layers { name: "muscle" kind: SKIN } layers { name: "muscle2" kind: MUSCLE down_to_bone { } })"));
  EXPECT_EQ(spec.layers(0).thickness_mm().constant(), 4.0);
  EXPECT_EQ(spec.layers(0).youngs_modulus_kpa(), 0.5);
  EXPECT_EQ(spec.layers(0).poisson_ratio(), 0.0) << "a zero that is given is given";
  EXPECT_EQ(spec.layers(0).density_kg_m3(), 7.0);
  EXPECT_EQ(spec.layers(1).youngs_modulus_kpa(), 90.0) << "the kind goes before the name";
  EXPECT_EQ(spec.layers(2).youngs_modulus_kpa(), 500.0);
  EXPECT_FALSE(spec.layers(2).has_thickness_mm()) << "the bone says how thick it is";
}

TEST(TissueFigures, ElastographyIsNeoHookeanUnlessALayerSaysOtherwise) {
  const auto laws = [](const std::string& rest) {
    std::vector<solid::TissueLaw> found;
    const auto spec = to_face_model_spec(square_with(rest));
    EXPECT_TRUE(spec.ok()) << spec.status();
    for (const model::TissueLayerSpec& layer : spec->layers) found.push_back(layer.material.law);
    return found;
  };
  using enum solid::TissueLaw;
  EXPECT_EQ(laws(R"(tissue_preset: ELASTOGRAPHY layers { name: "skin" } layers { name: "smas" law: COROTATIONAL })"),
            (std::vector{kNeoHookean, kCorotational}));
  EXPECT_EQ(laws(R"(tissue_preset: PAPER layers { name: "skin" } layers { name: "muscle" law: NEO_HOOKEAN })"),
            (std::vector{kCorotational, kNeoHookean}));
  EXPECT_EQ(laws(R"(layers { name: "skin" thickness_mm { constant: 2 } youngs_modulus_kpa: 90 poisson_ratio: 0.4
                    density_kg_m3: 1100 })"),
            std::vector{kCorotational});
}

TEST(TissueFigures, ALawThatIsNoneIsRefused) {
  v1::ModelSpec spec = square_with(R"(tissue_preset: PAPER layers { name: "skin" })");
  spec.mutable_layers(0)->set_law(static_cast<v1::TissueLayer::Law>(7));
  EXPECT_THAT(fields_of(to_face_model_spec(spec).status()), UnorderedElementsAre("layers[0].law"));
}

TEST(TissueFigures, WithoutAPresetNothingIsFilled) {
  const v1::ModelSpec spec = square_with(R"(layers { name: "skin" })");
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(spec, fill_tissue_figures(spec)));
  EXPECT_THAT(fields_of(to_face_model_spec(spec).status()),
              UnorderedElementsAre("layers[0].thickness_mm", "layers[0].youngs_modulus_kpa", "layers[0].poisson_ratio",
                                   "layers[0].density_kg_m3"));
}

TEST(TissueFigures, AKindThePresetDoesNotKnowIsNamedWithThoseItKnows) {
  const absl::Status status = to_face_model_spec(square_with(R"(
    tissue_preset: ELASTOGRAPHY layers { name: "skin" }
    layers { name: "gel" thickness_mm { constant: 2 } poisson_ratio: 0.4 density_kg_m3: 1000 })"))
                                  .status();
  EXPECT_THAT(fields_of(status), UnorderedElementsAre("layers[1].youngs_modulus_kpa"));
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("name 'gel' is one that the preset ELASTOGRAPHY knows: skin, subcutaneous, smas, muscle"));
}

TEST(TissueFigures, LayersCarryTheirKindTensionAndThicknessIntoTheCore) {
  const auto spec = to_face_model_spec(square_with(R"(
    tissue_preset: ELASTOGRAPHY
    layers { name: "skin" prestress_kpa: 20 regional_thickness: true }
    layers { name: "gel" thickness_mm { constant: 2 } youngs_modulus_kpa: 1 poisson_ratio: 0.4 density_kg_m3: 1000 }
    layers { name: "muscle" down_to_bone { max_thickness_mm: 12 smoothing_mm: 5 } })"));
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_EQ(spec->layers[0].kind, anatomy::TissueKind::kSkin);
  EXPECT_TRUE(spec->layers[0].regional_thickness);
  EXPECT_DOUBLE_EQ(spec->layers[0].material.prestress, 20e3);
  EXPECT_FALSE(spec->layers[1].kind.has_value());
  EXPECT_EQ(spec->layers[1].material.prestress, 0.0);
  EXPECT_DOUBLE_EQ(spec->layers[2].down_to_bone->max_thickness, 12e-3);
  EXPECT_DOUBLE_EQ(spec->layers[2].down_to_bone->smoothing, 5e-3);
  EXPECT_DOUBLE_EQ(spec->layers[2].down_to_bone->min_thickness, 1e-3) << "the default of the core";
  EXPECT_FALSE(spec->bone.has_value());
}

TEST(TissueFigures, ThicknessAndTheBoneExcludeEachOther) {
  EXPECT_THAT(fields_of(to_face_model_spec(square_with(R"(
    tissue_preset: PAPER layers { name: "muscle" thickness_mm { constant: 2 } down_to_bone { } })"))
                            .status()),
              UnorderedElementsAre("layers[0].thickness_mm"));
}

}  // namespace
}  // namespace lipofill::server
