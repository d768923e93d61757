#include "core/anatomy/tissue_presets.h"

#include <gmock/gmock.h>

namespace lipofill::anatomy {
namespace {

using ::testing::ElementsAre;

/// Ranges the sources give; each default lies within.
struct Range {
  TissueKind kind;
  double thickness_mm[2];
  double elastography_kpa[2];
};

TEST(TissuePresets, LieWithinThePublishedRanges) {
  constexpr Range kRanges[] = {{TissueKind::kSkin, {1.5, 2.0}, {90, 500}},
                               {TissueKind::kSubcutaneous, {1.6, 5.1}, {1, 20}},
                               {TissueKind::kSmas, {1, 1}, {20, 200}},
                               {TissueKind::kMuscle, {8.7, 15}, {10, 500}}};
  for (const Range& range : kRanges) {
    const TissueFigures tissue = figures_of(TissuePreset::kElastography, range.kind);
    EXPECT_GE(tissue.thickness * 1e3, range.thickness_mm[0]);
    EXPECT_LE(tissue.thickness * 1e3, range.thickness_mm[1]);
    EXPECT_GE(tissue.youngs_modulus, range.elastography_kpa[0] * 1e3);
    EXPECT_LE(tissue.youngs_modulus, range.elastography_kpa[1] * 1e3);
    EXPECT_LT(tissue.poisson_ratio, 0.5);
  }
}

TEST(TissuePresets, ThePaperHasItsOwnModuliAndNothingElse) {
  EXPECT_EQ(figures_of(TissuePreset::kPaper, TissueKind::kSkin).youngs_modulus, 90e3);
  EXPECT_EQ(figures_of(TissuePreset::kPaper, TissueKind::kMuscle).youngs_modulus, 500e3);
  for (const std::string& name : tissue_kind_names()) {
    const TissueFigures paper = figures_of(TissuePreset::kPaper, *find_tissue_kind(name));
    const TissueFigures other = figures_of(TissuePreset::kElastography, *find_tissue_kind(name));
    EXPECT_GE(paper.youngs_modulus, 90e3);
    EXPECT_LE(paper.youngs_modulus, 500e3);
    EXPECT_EQ(paper.thickness, other.thickness);
    EXPECT_EQ(paper.poisson_ratio, other.poisson_ratio);
    EXPECT_EQ(paper.density, other.density);
  }
}

TEST(TissuePresets, AreFoundByName) {
  EXPECT_THAT(tissue_kind_names(), ElementsAre("skin", "subcutaneous", "smas", "muscle"));
  for (const std::string& name : tissue_kind_names()) EXPECT_EQ(name_of(*find_tissue_kind(name)), name);
  for (const char* name : {"", "Skin", "fascia", "skin "}) EXPECT_FALSE(find_tissue_kind(name).has_value()) << name;
}

}  // namespace
}  // namespace lipofill::anatomy
