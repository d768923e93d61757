#include "core/anatomy/fat_presets.h"

#include <algorithm>

namespace lipofill::anatomy {
namespace {

constexpr double kDensity = 920.0;            // [kg/m3] assumed
constexpr double kNewtonianViscosity = 15.0;  // [Pa s]
constexpr double kColemanModulus = 70.0;      // [Pa] Ding 2021
constexpr double kColemanConsistency = 48.0;  // [Pa s^n] Ding 2021, Lee 2011
constexpr double kFlowIndex = 0.28;           // Ding 2021, Lee 2011
constexpr double kYieldStrain = 0.1;          // assumed
constexpr double kLargestYieldStress = 20.0;  // [Pa] assumed
constexpr double kNanofatModulus = 35.0;      // [Pa] Ding 2021
constexpr double kSvfGelModulus = 202.0;      // [Pa] Ding 2021

/// A preparation of which the elastic modulus was measured: its flow is that of Coleman fat, in
/// proportion.
FatFigures in_proportion_to_coleman(double shear_modulus) {
  return {kColemanConsistency * shear_modulus / kColemanModulus, kFlowIndex,
          std::min(kYieldStrain * shear_modulus, kLargestYieldStress), shear_modulus, kDensity};
}

}  // namespace

FatFigures figures_of(FatPreset preset) {
  switch (preset) {
    case FatPreset::kColeman:
      return in_proportion_to_coleman(kColemanModulus);
    case FatPreset::kNanofat:
      return in_proportion_to_coleman(kNanofatModulus);
    case FatPreset::kSvfGel:
      return in_proportion_to_coleman(kSvfGelModulus);
    case FatPreset::kNewtonian:
      break;
  }
  return {kNewtonianViscosity, 1.0, 0.0, 0.0, kDensity};
}

}  // namespace lipofill::anatomy
