#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::verification {

/// The sample plan jaw_angle and the face shipped with it, in SI and in the scan's frame.
struct JawPlan {
  model::FaceModelSpec model;
  plan::SimulationSpec simulation;
  bool ok = false;
};

/// From client/examples/plans/jaw_angle.json; not ok where that fails, and the test with it.
JawPlan load_jaw_plan();
/// The same of another sample plan, on that face or on a square.
/// @param scan  the face of a plan that names none; OBJ or PLY in millimetres
JawPlan load_sample_plan(const std::string& file, const std::filesystem::path& scan = {});

struct JawCase {
  std::shared_ptr<const model::FaceModel> model;
  plan::SimulationSpec spec;
};

/// Builds the model of load_jaw_plan(); it is null where that fails, and the test with it.
JawCase make_jaw_case();

}  // namespace lipofill::verification
