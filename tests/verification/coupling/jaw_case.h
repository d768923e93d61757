#pragma once

#include <memory>

#include "core/simulation/face_model.h"
#include "core/simulation/simulation_spec.h"

namespace lipofill::verification {

/// The sample plan jaw_angle on the face shipped with it.
struct JawCase {
  std::shared_ptr<const simulation::FaceModel> model;
  simulation::SimulationSpec spec;
};

/// Builds it from client/examples/plans/jaw_angle.json; the model is null where that fails, and the test with it.
JawCase make_jaw_case();

}  // namespace lipofill::verification
