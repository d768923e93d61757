#include "core/anatomy/fat_presets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lipofill::anatomy {
namespace {

double viscosity_of_flow(const FatFigures& fat, double rate) {
  return fat.consistency * std::pow(rate, fat.flow_index - 1.0);
}

TEST(FatPresets, AreFluidsASolverTakes) {
  for (const FatPreset preset : kAllFatPresets) {
    const FatFigures fat = figures_of(preset);
    EXPECT_GT(fat.consistency, 0.0);
    EXPECT_GT(fat.flow_index, 0.0);
    EXPECT_LE(fat.flow_index, 1.0);
    EXPECT_GE(fat.shear_modulus, 0.0);
    EXPECT_EQ(fat.density, 920.0);
  }
}

TEST(FatPresets, ColemanFatHasTheDynamicViscosityThatWasMeasured) {
  const double omega = 2.0 * std::numbers::pi * 0.77;
  const double measured = std::hypot(70.0, 25.0) / omega;
  EXPECT_NEAR(viscosity_of_flow(figures_of(FatPreset::kColeman), omega), measured, 0.01 * measured);
  EXPECT_NEAR(figures_of(FatPreset::kNewtonian).consistency, measured, 0.05 * measured);
}

TEST(FatPresets, TheNewtonianOneFlowsAtAnyStress) {
  const FatFigures fat = figures_of(FatPreset::kNewtonian);
  EXPECT_EQ(fat.flow_index, 1.0);
  EXPECT_EQ(fat.yield_stress, 0.0);
  EXPECT_EQ(fat.shear_modulus, 0.0);
}

TEST(FatPresets, PreparationsAreInTheOrderOfTheirMeasuredModuli) {
  const FatFigures nanofat = figures_of(FatPreset::kNanofat);
  const FatFigures coleman = figures_of(FatPreset::kColeman);
  const FatFigures gel = figures_of(FatPreset::kSvfGel);
  EXPECT_EQ(nanofat.shear_modulus, 35.0);
  EXPECT_EQ(coleman.shear_modulus, 70.0);
  EXPECT_EQ(gel.shear_modulus, 202.0);
  EXPECT_LT(nanofat.yield_stress, coleman.yield_stress);
  EXPECT_LT(coleman.yield_stress, gel.yield_stress);
  EXPECT_NEAR(nanofat.consistency / coleman.consistency, 0.5, 1e-12);
  for (const FatFigures& fat : {nanofat, coleman, gel}) {
    EXPECT_GE(fat.yield_stress, 1.0);
    EXPECT_LE(fat.yield_stress, 20.0);
  }
}

}  // namespace
}  // namespace lipofill::anatomy
