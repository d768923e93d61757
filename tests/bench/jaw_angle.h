#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::bench {

inline constexpr int kTinyScale = 0;
inline constexpr double kTinyShare = 0.25;

/// The sample plan jaw_angle, which is of the paper's size, and the face shipped with it: what
/// there is to build from.
struct SampleFace {
  model::FaceModelSpec model;
  plan::SimulationSpec simulation;
  plan::SimulationSpec settled_shape;  ///< the same with that goal: few long steps
};

/// From client/examples/plans/jaw_angle.json, refined in the plane of the face: `scale` 1, 4, 16 or
/// 64 has as many hexahedra and film cells as that times those of the plan, kTinyScale kTinyShare
/// of them. INVALID_ARGUMENT for other scales.
absl::StatusOr<SampleFace> load_sample_face(int scale);

/// The same, built.
struct JawAngle {
  int scale = 1;
  std::shared_ptr<const model::FaceModel> model;
  plan::SimulationSpec spec;
  plan::SimulationSpec settled_shape;
  /// The same with a yield stress far below what it takes to matter, for which it is stepped.
  plan::SimulationSpec settled_in_steps;
};
absl::StatusOr<JawAngle> make_jaw_angle(int scale);
/// The same with neo-Hookean layers and the attachments of the face's regions around the zones.
absl::StatusOr<JawAngle> make_attached_jaw_angle(int scale);

}  // namespace lipofill::bench
