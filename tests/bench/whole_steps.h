#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/simulation/simulation.h"
#include "server/sessions/frame.h"
#include "tests/bench/jaw_angle.h"
#include "tests/bench/measure.h"
#include "tests/bench/step_costs.h"

namespace lipofill::bench {

/// Steps of the plan's own size in the midst of its injection, as a session takes them: advance,
/// take a frame of what viewers see by default, encode it. The same simulated time at every scale,
/// so that scales can be compared.
class WholeSteps {
 public:
  /// Goes to the midst of the injection in larger steps, which are not measured.
  static absl::StatusOr<std::unique_ptr<WholeSteps>> create(const JawAngle& jaw);

  /// INTERNAL when the simulation fails.
  absl::Status advance(int n_steps);

  const simulation::Simulation& simulation() const { return *simulation_; }
  /// "step", "frame" and "encoding", and the latter two "_of_all_meshes".
  const PhaseSamples& samples() const { return samples_; }
  nlohmann::ordered_json to_json() const;

 private:
  explicit WholeSteps(std::unique_ptr<simulation::Simulation> simulation) : simulation_(std::move(simulation)) {}
  void take_frame(const std::vector<std::string>& meshes, const std::string& suffix);

  std::unique_ptr<simulation::Simulation> simulation_;
  PhaseSamples samples_;
  StepCosts costs_;
  std::map<std::string, size_t> frame_bytes_;
};

/// One run of a plan from pressing run to the settled shape.
struct SettledRun {
  Span stepping;      ///< it runs from the first step to the last
  Span creation;      ///< before the first step
  StepCosts costs;    ///< the same steps took these
  Samples injecting;  ///< steps of the plan's size while fat flows in
  int steps = 0;
  double simulated_s = 0.0;
  double skin_max_displacement_mm = 0.0;
  double skin_volume_change_ml = 0.0;
  std::string state_hash;

  nlohmann::ordered_json to_json() const;
};

/// INTERNAL when the simulation fails or ends before it settles.
absl::StatusOr<SettledRun> run_to_settled(const JawAngle& jaw, const plan::SimulationSpec& spec);

}  // namespace lipofill::bench
