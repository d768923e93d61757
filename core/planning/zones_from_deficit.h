#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/scalar_field.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::planning {

/// Zones that may be added to a plan.
struct ZoneProposals {
  std::vector<std::string> below_layers;  ///< planes fat may lie in; empty: below every layer
  int max_zones = 4;                      ///< together, over all planes
  double min_deficit = 1e-3;              ///< skin that lacks less is left as it is [m]
};

/// A choice of zones to try.
struct ZoneLayout {
  std::string description;  ///< "one plane, below fat, where 35 % are missing"
  plan::SimulationSpec plan;
  int n_proposed = 0;  ///< zones that the plan did not have
};

/// Painted zones around what is missing: a zone a hollow, inside the line where the deficit is
/// `level` times that in the middle of its hollow, and at least `min_deficit`. The deficit is
/// smooth, and so is the line. Zones keep clear of the rim of the model, where the tissue is held;
/// those of less than 1 cm2 are left out. The largest come first, named "<prefix>1" on. Checked by
/// tests/unit/planning/zones_from_deficit_test.cc.
std::vector<plan::ZoneSpec> outline_hollows(const model::FaceModel& model, const geometry::ScalarField& deficit,
                                            double level, double min_deficit, const std::string& prefix);

/// The choices for a plan, in a fixed order: in one plane inside of each of three levels; in two
/// planes, wide zones in the deeper and narrow ones in the other. Zones join the film that the plan
/// has in a plane; where it has none they have a film of their own over the whole chart.
/// INVALID_ARGUMENT with field violations of "zones.below_layers[k]" for layers that the model does
/// not have.
absl::StatusOr<std::vector<ZoneLayout>> list_zone_layouts(const model::FaceModel& model,
                                                          const plan::SimulationSpec& plan,
                                                          const geometry::ScalarField& deficit,
                                                          const ZoneProposals& proposals);

}  // namespace lipofill::planning
