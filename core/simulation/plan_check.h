#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/field_violations.h"
#include "core/base/unwanted.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::simulation {

/// A zone of a plan on the model.
struct PlacedZone {
  int number = 0;  ///< counted from 1 through the zones of the plan's films in order
  std::string film;
  std::string name;
  int n_cells = 0;
  double area = 0.0;  ///< of the skin over its cells [m2]
  /// Closed lines around it on the undeformed skin [m] (3, n): as drawn, or along its cells
  /// (plan::ZoneOutline).
  std::vector<Eigen::Matrix3Xd> outline;
};

/// The check says what can be said of a plan on a model before its tissue is set up.
struct PlanCheck {
  /// Everything for which Simulation::create would refuse the plan, but for what only the tissue at
  /// work shows: an initial thickness that it cannot open to.
  std::vector<FieldViolation> violations;
  /// The remarks say what a simulation of the plan would do that its author may not have meant.
  std::vector<FieldViolation> remarks;
  std::vector<PlacedZone> zones;  ///< those that could be placed
  /// Number of the zone of the outermost film under each node of the skin; 0: none.
  /// (nodes_per_level)
  std::vector<int> zone_under_skin;
};

/// Checks a plan on a model and finds where its zones are: no factor is analysed and no step is
/// taken. Fields are named as in lipofill.v1.SimulationSpec. CANCELLED once it is unwanted. Checked
/// by tests/unit/simulation/plan_check_test.cc, and by every plan that tests/unit/simulation/ has
/// refused.
absl::StatusOr<PlanCheck> check_plan_on_model(const model::FaceModel& model, const plan::SimulationSpec& spec,
                                              const Unwanted& unwanted);

}  // namespace lipofill::simulation
