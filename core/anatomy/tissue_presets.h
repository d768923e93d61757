#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lipofill::anatomy {

/// Tissue a layer of the face is made of.
enum class TissueKind { kSkin, kSubcutaneous, kSmas, kMuscle };

/// The source of the moduli.
enum class TissuePreset { kPaper, kElastography };

struct TissueFigures {
  double thickness = 0.0;       ///< [m]
  double youngs_modulus = 0.0;  ///< [Pa]
  double poisson_ratio = 0.0;   ///< [1]
  double density = 0.0;         ///< [kg/m3]
};

/// Figures of a kind of tissue:
///
/// | kind         | thickness mm   | E kPa, elastography | E kPa, paper     | nu   | density kg/m3 |
/// |--------------|----------------|---------------------|------------------|------|---------------|
/// | skin         | 1.8 (1.5-2.0)  | 100 (90-500)        | 90 (90-500)      | 0.48 | 1100          |
/// | subcutaneous | 3 (1.6-5.1)    | 3 (1-20)            | 90 (assumed)     | 0.49 | 950           |
/// | smas         | 1 (assumed)    | 50 (20-200)         | 90 (assumed)     | 0.45 | 1050          |
/// | muscle       | 10 (8.7-15)    | 20 (10-500)         | 500              | 0.49 | 1050          |
///
/// Sources. Thickness: skin, subcutaneous Clin Anat 2019 (pubmed 30882511); masseter Kiliaridis
/// 1991. Elastography: skin after the paper's range; fat JMBBM 2023 (|G*| 752 Pa); SMAS Har-Shai
/// 1996/97 (like skin, less viscous); muscle at rest 7-36 kPa. Paper: Majorczyk et al., skin
/// 0.09-0.5 MPa and muscle 0.5 MPa; it has no other layer and gives neither Poisson ratio nor
/// density nor thickness, so its subcutaneous fat and SMAS take the softest modulus it names, the
/// rest is as in the other preset (assumed). Its muscle is some 25 times stiffer than muscle at
/// rest: predicted pressure depends on it. Checked by tests/unit/anatomy/tissue_presets_test.cc.
TissueFigures figures_of(TissuePreset preset, TissueKind kind);

/// Name of a kind of tissue: "skin", "subcutaneous", "smas", "muscle".
std::vector<std::string> tissue_kind_names();
std::string_view name_of(TissueKind kind);

/// The kind of that name; nothing for any other.
std::optional<TissueKind> find_tissue_kind(std::string_view name);

}  // namespace lipofill::anatomy
