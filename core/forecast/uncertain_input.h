#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/forecast/distribution.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::forecast {

/// kLayerModulus, kLayerThickness and kZoneVolume are multiples of what model and plan have;
/// kPlaceXi and kPlaceEta lengths on the skin [m]; kRetention the share left after 12 months.
enum class Quantity { kLayerModulus, kLayerThickness, kZoneVolume, kPlaceXi, kPlaceEta, kRetention };

/// Something that is not known exactly.
struct UncertainInput {
  Quantity quantity = Quantity::kLayerModulus;
  std::string name;  ///< of the layer or the zone; empty for the others
  Distribution distribution;
  std::string source;
  bool is_assumed = false;  ///< an engineering choice, not a published figure

  bool is_same(const UncertainInput& other) const { return quantity == other.quantity && name == other.name; }
  /// For people: "stiffness of skin".
  std::string describe() const;
};

/// Lists what is uncertain of a plan on a model by default, but for retention: stiffness and
/// thickness of each layer by its kind, the volume that each zone gets, and where landmarks put the
/// zones.
///
/// A published range of E or of a thickness counts as four standard deviations of the logarithm
/// (Hozo et al. 2005 for samples of some tens), and the model's own value as the median: the range
/// holds persons and methods of measurement alike. A layer whose kind is not known takes that of
/// its name, or else the spread of muscle.
///
/// | kind         | E kPa   | sd of ln E | thickness mm | sd of ln h     |
/// |--------------|---------|------------|--------------|----------------|
/// | skin         | 90-500  | 0.43       | 1.5-2.0      | 0.07           |
/// | subcutaneous | 1-20    | 0.75       | 1.6-5.1      | 0.29           |
/// | smas         | 20-200  | 0.58       | -            | 0.20 (assumed) |
/// | muscle       | 10-500  | 0.98       | 8.7-15       | 0.14           |
///
/// Checked by tests/unit/forecast/uncertain_input_test.cc.
std::vector<UncertainInput> default_inputs(const std::vector<model::TissueLayerSpec>& layers,
                                           const plan::SimulationSpec& plan);

/// The defaults with those that are given in their place or beside them; the given ones alone where
/// nothing else is to be uncertain. Field violations "inputs[k]..." for distributions that reach
/// what is not possible, names that model and plan do not have, and inputs given twice.
absl::StatusOr<std::vector<UncertainInput>> choose_inputs(const std::vector<model::TissueLayerSpec>& layers,
                                                          const plan::SimulationSpec& plan,
                                                          const std::vector<UncertainInput>& given, bool only_given);

}  // namespace lipofill::forecast
