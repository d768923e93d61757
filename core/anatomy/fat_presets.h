#pragma once

#include <array>

namespace lipofill::anatomy {

/// Preparations of fat as they are injected.
enum class FatPreset { kNewtonian, kColeman, kNanofat, kSvfGel };

inline constexpr std::array kAllFatPresets = {FatPreset::kNewtonian, FatPreset::kColeman, FatPreset::kNanofat,
                                              FatPreset::kSvfGel};

/// A Herschel-Bulkley fluid, elastic below and at short times:
///
///     tau = yield_stress + consistency * rate^flow_index        rate: shear rate [1/s]
///
/// flow_index 1 and yield_stress 0 are Newton's fluid, whose viscosity [Pa s] is the consistency.
struct FatFigures {
  double consistency = 0.0;    ///< [Pa s^flow_index]
  double flow_index = 1.0;     ///< n, in (0, 1]
  double yield_stress = 0.0;   ///< [Pa]
  double shear_modulus = 0.0;  ///< G' [Pa]; 0: no elasticity
  double density = 0.0;        ///< [kg/m3]
};

/// Figures of a preparation:
///
/// | preset    | consistency | n    | yield stress | G'  |
/// |-----------|-------------|------|--------------|-----|
/// | NEWTONIAN | 15          | 1    | 0            | 0   |
/// | COLEMAN   | 48          | 0.28 | 7            | 70  |
/// | NANOFAT   | 24          | 0.28 | 3.5          | 35  |
/// | SVF_GEL   | 138.5       | 0.28 | 20           | 202 |
///
/// Sources. G' of the three preparations and G'' = 25 Pa of Coleman fat, at 0.77 Hz and 25 C: Ding
/// 2021. n = 0.28: inferred from Ding 2021 and Lee 2011. Consistency of Coleman fat: the dynamic
/// viscosity |G*| / omega = 15.4 Pa s at 0.77 Hz is 48 omega^(n-1); the Newtonian default is that
/// viscosity, rounded. Assumed: the loss tangent of the other two is that of Coleman fat, so that
/// their consistency goes with G'; every yield stress is a tenth of G' (a yield strain of 0.1), at
/// most 20 Pa, within the 1-20 Pa thought possible; density 920 kg/m3.
///
/// The elastic modulus is a measurement of the preparation as injected, not of the graft that
/// takes.
/// Checked by tests/unit/anatomy/fat_presets_test.cc.
FatFigures figures_of(FatPreset preset);

}  // namespace lipofill::anatomy
