#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "core/simulation/face_model.h"
#include "core/simulation/simulation_spec.h"

namespace lipofill::bench {

/// The sample plan jaw_angle, which is of the paper's size, and the face shipped with it.
struct JawAngle {
  int scale = 1;  ///< hexahedra over those of the plan; kTinyScale: kTinyShare of them
  std::shared_ptr<const simulation::FaceModel> model;
  simulation::SimulationSpec spec;
};

inline constexpr int kTinyScale = 0;
inline constexpr double kTinyShare = 0.25;

/// From client/examples/plans/jaw_angle.json, refined in the plane of the face: `scale` 1, 4, 16 or 64 has as many
/// hexahedra and film cells as that times those of the plan. INVALID_ARGUMENT for other scales.
absl::StatusOr<JawAngle> make_jaw_angle(int scale);

}  // namespace lipofill::bench
