// What a segmentation means by the names and numbers of its labels.

#include "client/cpp/volume/tissue_labels.h"

#include <gmock/gmock.h>

namespace lipofill::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

TEST(TissueLabels, NamesThatSegmentationsHaveAreUnderstood) {
  for (const char* name : {"Skin", "skin_surface", "Haut", "epidermis"})
    EXPECT_EQ(tissue_named(name), Tissue::kSkin) << name;
  for (const char* name : {"Fat", "subcutaneous fat", "SAT", "Adipose tissue", "Subcutaneous tissue of the skin"})
    EXPECT_EQ(tissue_named(name), Tissue::kFat) << name;
  for (const char* name : {"M. masseter", "masseter_left", "Muscle", "Skeletal muscle", "Musculus buccinator"})
    EXPECT_EQ(tissue_named(name), Tissue::kMuscle) << name;
  for (const char* name : {"Bone", "Mandible", "Upper Skull", "lower_jaw", "Unterkiefer", "Teeth", "os zygomaticum"})
    EXPECT_EQ(tissue_named(name), Tissue::kBone) << name;
  for (const char* name : {"Dental implant", "metal artefact"}) EXPECT_EQ(tissue_named(name), Tissue::kMetal) << name;
  for (const char* name : {"airway", "brain", "", "satin", "Segment_1", "nose"})
    EXPECT_EQ(tissue_named(name), std::nullopt) << name;
}

TEST(TissueLabels, WhatTheCallerSaysComesBeforeTheNames) {
  const LabelNames names = {{1, "Skin"}, {2, "Segment_2"}, {7, "Mandible"}};
  const auto labels = find_tissue_labels("a.nrrd", names, {"fat=2", "muscle=mandible", "bone=9"});
  ASSERT_TRUE(labels.ok()) << labels.status();
  EXPECT_THAT(*labels, ElementsAre(Pair(1, Tissue::kSkin), Pair(2, Tissue::kFat), Pair(7, Tissue::kMuscle),
                                   Pair(9, Tissue::kBone)));
  EXPECT_THAT(std::string(find_tissue_labels("a.nrrd", names, {"fat=Liver"}).status().message()),
              HasSubstr("no label named \"Liver\"; there are Skin (1), Segment_2 (2), Mandible (7)"));
  EXPECT_THAT(std::string(find_tissue_labels("a.nrrd", {}, {"fat=Liver"}).status().message()),
              HasSubstr("names none of its labels"));
  for (const char* wrong : {"fat", "liver=2", "=2", "bone="})
    EXPECT_THAT(std::string(find_tissue_labels("a.nrrd", names, {wrong}).status().message()),
                HasSubstr("tissues are skin, fat, muscle, bone and metal"))
        << wrong;
}

TEST(TissueLabels, ATissueIsAllItsLabels) {
  const LabelNames names = {{1, "Skin"}, {2, "Skull"}, {7, "Mandible"}};
  EXPECT_THAT(*choose_labels("a.nrrd", names, {"bone"}), ElementsAre(2, 7));
  EXPECT_THAT(*choose_labels("a.nrrd", names, {"skull", "12"}), ElementsAre(2, 12));
  EXPECT_THAT(*choose_labels("a.nrrd", names, {"2", "all"}), IsEmpty()) << "which means every label";
  EXPECT_FALSE(choose_labels("a.nrrd", names, {"fat"}).ok());
}

}  // namespace
}  // namespace lipofill::client
