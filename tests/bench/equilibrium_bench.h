#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "absl/status/statusor.h"
#include "core/equilibrium/ensemble.h"
#include "core/plan/plan_placement.h"
#include "core/step/coupled_step.h"
#include "tests/bench/jaw_angle.h"
#include "tests/bench/measure.h"

namespace lipofill::bench {

/// The settled shape of jaw_angle, found directly, beside F: one assembly, factorisation in float32
/// and solve of the same tissue. What a model can keep at hand is there before.
class EquilibriumBench {
 public:
  static absl::StatusOr<std::unique_ptr<EquilibriumBench>> create(const JawAngle& jaw);

  /// Does everything in turn.
  absl::Status run_round();
  int scale() const { return scale_; }
  /// F [ms], and everything else over F.
  nlohmann::ordered_json to_json() const;

 private:
  EquilibriumBench() = default;
  /// The same tissue with a layer a little thicker.
  struct Thicker {
    std::shared_ptr<const model::FaceModel> model;
    std::unique_ptr<step::CoupledStep> stepper;
    std::unique_ptr<equilibrium::Equilibrium> equilibrium;
  };

  absl::Status set_up(const JawAngle& jaw);
  absl::Status add_thicker(int layer, const JawAngle& jaw);
  absl::StatusOr<std::unique_ptr<equilibrium::Equilibrium>> make_equilibrium(const model::FaceModel& model,
                                                                             step::CoupledStep& stepper,
                                                                             const JawAngle& jaw) const;
  absl::Status measure_unit();
  void measure_cold();
  void measure_drag();
  void measure_sensitivities();
  absl::Status measure_thicker_tissue();
  absl::Status measure_members();
  absl::Status check_members(const std::vector<absl::StatusOr<equilibrium::Settled>>& members);

  int scale_ = 1;
  std::shared_ptr<const model::FaceModel> model_;
  plan::SimulationSpec spec_;
  plan::PlacedPlan placed_;
  std::unique_ptr<step::CoupledStep> stepper_;
  std::unique_ptr<mechanics::TissueFactor> factor_;
  std::unique_ptr<equilibrium::Equilibrium> equilibrium_;
  std::vector<Thicker> beside_;  ///< one a layer
  equilibrium::PoolTarget target_;
  Eigen::VectorXd springs_;
  equilibrium::Settled exact_;  ///< with forces to 1e-9
  double error_mm_ = 0.0;       ///< of the skin, of the shape that is found cold
  equilibrium::SolverCost cold_cost_;
  int n_sensitivities_ = 0;
  int drag_iterations_ = 0, drag_factors_ = 0;      ///< of all shapes of drags
  int member_factors_ = 0, member_iterations_ = 0;  ///< of all members, twice
  Samples unit_, cold_, drag_, sensitivity_, member_, batch_, thicker_;
};

}  // namespace lipofill::bench
