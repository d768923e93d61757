#pragma once

#include <Eigen/Core>
#include <memory>

#include "absl/status/statusor.h"
#include "core/coupling/coupled_factor.h"
#include "core/mechanics/tissue_system.h"

namespace lipofill::mechanics {

/// The factor of S with the films' B that iterations go on with, of the present positions or of
/// earlier ones.
///
/// It is made in float32. Where that is not enough - no positive pivots, or a solve under load
/// leaves more than kFactorTolerance of the load - it is made in float64 from then on. It is kept
/// until the iterations that a new one would have saved have cost as much as making it (decision
/// 008). Which factor is in use is part of the simulation's state (SimulationState::factored_*), so
/// that a restored simulation goes on with the same bits.
/// Checked by tests/unit/mechanics/held_factor_test.cc.
class HeldFactor {
 public:
  enum class TakenUp { kAtHand, kMade, kImpossible };

  /// Analyses the pattern of `system`, with the pressures where there are few enough for a dense
  /// compliance. A field violation of "model" when the factor would need more memory than a session
  /// may take.
  /// @param system  the tissue that is factored; outlives the factor, as does `cost`
  static absl::StatusOr<std::unique_ptr<HeldFactor>> create(const model::FaceModel& model, TissueSystem& system,
                                                            StepCost& cost);

  /// Factors at x. False when the system is not positive definite, or the factor not exact enough,
  /// in that precision.
  bool factor_at(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs, double dt, coupling::Precision precision);

  /// True when a step from this state begins with a new factor.
  static bool is_due(const SimulationState& state);
  /// Factors at the state's positions, in float32 as long as that has been enough, and notes it
  /// there. False when the tissue is not positive definite.
  bool renew(double dt, SimulationState& state);
  /// Factors where the state says that it was factored last, unless that is the factor at hand.
  TakenUp take_up(const SimulationState& state);
  /// True when the factor is of other positions than these.
  bool is_late(const Eigen::Matrix3Xd& x) const { return !is_same(positions_, x); }

  coupling::CoupledFactor& factor() { return factor_; }
  const coupling::CoupledFactor& factor() const { return factor_; }
  bool has_compliance() const { return factor_.has_compliance(); }

 private:
  HeldFactor(TissueSystem& system, std::shared_ptr<const coupling::FactorAnalysis> analysis, StepCost& cost)
      : system_(system), cost_(cost), factor_(std::move(analysis)) {}
  double measure_error();

  TissueSystem& system_;
  StepCost& cost_;
  coupling::CoupledFactor factor_;
  Eigen::Matrix3Xd positions_;  ///< the factor at hand was made there
  Eigen::VectorXd springs_;
  double dt_ = 0.0;  ///< [s]; 0: there is no factor that can be used
  coupling::Precision precision_ = coupling::Precision::kSingle;
  /// The load that a new factor is tried with, and what comes of it.
  struct Trial {
    Eigen::VectorXd pressure, load, weight, response, displacement, left;
  };
  Trial trial_;
};

}  // namespace lipofill::mechanics
