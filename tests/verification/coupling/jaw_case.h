#pragma once

#include <memory>

#include "core/simulation/face_model.h"
#include "core/simulation/simulation_spec.h"

namespace lipofill::verification {

/// The sample plan jaw_angle and the face shipped with it, in SI and in the scan's frame.
struct JawPlan {
  simulation::FaceModelSpec model;
  simulation::SimulationSpec simulation;
  bool ok = false;
};

/// From client/examples/plans/jaw_angle.json; not ok where that fails, and the test with it.
JawPlan load_jaw_plan();

struct JawCase {
  std::shared_ptr<const simulation::FaceModel> model;
  simulation::SimulationSpec spec;
};

/// Builds the model of load_jaw_plan(); it is null where that fails, and the test with it.
JawCase make_jaw_case();

}  // namespace lipofill::verification
