#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/mechanics/held_factor.h"
#include "core/step/film_step.h"
#include "core/step/predictor.h"
#include "core/step/residual_force.h"

namespace lipofill::step {

/// The outcome of trying a step.
struct StepOutcome {
  bool accepted = false;
  std::string reason;  ///< why not
  mechanics::SimulationState state;
  Eigen::VectorXd gap;               ///< rest + g at the new positions [m3] (cells of all films)
  Eigen::VectorXd void_volume;       ///< part of the gap at the suction limit [m3] (cells of all films)
  double elastic_energy = 0.0;       ///< [J]
  double kinetic_energy = 0.0;       ///< of the tissue [J]
  Eigen::VectorXd spring_tension;    ///< of every spring of a ligament [N]
  Eigen::VectorXd spring_length;     ///< [m]
  double min_scaled_jacobian = 1.0;  ///< of the tissue at the new positions
  double error = 0.0;                ///< estimate of the step's own, set by the simulation [m]
  int film_iterations = 0;
  int newton_iterations = 0;
};

/// One implicit Euler step of tissue and films together.
///
///     S dx - B^T p = f                 tissue: S = M/dt^2 + D/dt + K at the positions x
///     B dx + dt J p = d                films:  d = V + injected - outflow at zero pressure - rest - g(x)
///
/// with J the tangent of the fat's flow law and p not below the suction limit (film_solve.h),
/// repeated from the new positions (Newton) until forces balance to kForceTolerance and the gap
/// holds the film's volume to kGapTolerance. The mismatch that is left enters the next step's d: it
/// cannot accumulate.
///
/// S, B and C on the left may be those of earlier positions (held_factor.h): only the right sides
/// decide where the iteration ends,
///
///     S0 dx - B0^T p' = f(x) + (B(x) - B0)^T p
///     B0 dx + J p'    = d(x)
///
/// Checked by tests/unit/simulation/, tests/verification/coupling/ and tests/property/.
class CoupledStep {
 public:
  /// @param model, films  outlive the step
  static absl::StatusOr<std::unique_ptr<CoupledStep>> create(const model::FaceModel& model,
                                                             const std::vector<plan::FilmLayout>& films,
                                                             const plan::SimulationSpec& spec);

  /// Everything at rest; films at rest thickness.
  mechanics::SimulationState rest_state() const;
  /// Opens the tissue for the films' initial thickness. Errors as those of initial_opening.h.
  absl::Status open_to_initial_thickness(mechanics::SimulationState& state);

  /// @param injected  volume into each cell of each film [m3]
  /// @param outcome   what came of it; the memory of an earlier one is used again, so that steps
  ///                  allocate nothing
  void try_step(const mechanics::SimulationState& state, const std::vector<Eigen::VectorXd>& injected, double dt,
                StepOutcome& outcome);
  /// Figures of a state that does not come from try_step: gap, void, energies, springs.
  StepOutcome describe(const mechanics::SimulationState& state);

  /// The parts that finding a settled shape directly shares with steps; null without tissue.
  mechanics::TissueSystem* system() { return system_.get(); }
  const mechanics::FilmCells& cells() const { return cells_; }
  mechanics::StepCost& cost() { return cost_; }

  int n_dofs() const { return system_ ? system_->tissue().n_dofs() : 0; }
  /// Memory of the factor, the compliance, the matrices and the vectors, once steps are taken [B].
  uint64_t memory_bytes() const;
  /// The tissue as it was set up; null for a model without layers.
  const mechanics::TissueSetup* tissue() const { return system_ ? &system_->setup() : nullptr; }
  /// The mid-surfaces of the films.
  mechanics::FilmGeometry& geometry() { return *geometry_; }
  const mechanics::FilmGeometry& geometry() const { return *geometry_; }
  /// The cost of the steps since reset_cost.
  const mechanics::StepCost& cost() const { return cost_; }
  void reset_cost() { cost_ = {}; }

 private:
  explicit CoupledStep(const std::vector<plan::FilmLayout>& films)
      : layouts_(films), cells_(mechanics::number_cells(films)), predictor_(cells_) {}

  void predict(const mechanics::SimulationState& from, double dt, mechanics::SimulationState& next);
  bool solve_tissue_and_films(const mechanics::SimulationState& from, double dt, StepOutcome& outcome);
  bool begin_tissue(const mechanics::SimulationState& from, double dt, StepOutcome& outcome);
  bool take_up_factor(const mechanics::SimulationState& from, double dt, StepOutcome& outcome);
  bool renew_factor(double dt, StepOutcome& outcome);
  void find_gap_without_pressure();
  bool solve_films(StepOutcome& outcome);
  bool move_tissue(const mechanics::SimulationState& from, double dt, StepOutcome& outcome);
  double measure_error(double force_tolerance, StepOutcome& outcome);
  bool is_late(const StepOutcome& outcome) const;
  void find_gap(const Eigen::VectorXd& pressure, Eigen::VectorXd& gap) const;
  void finish_tissue(const mechanics::SimulationState& from, double dt, StepOutcome& outcome);
  void describe_tissue(StepOutcome& outcome, double dt);

  const std::vector<plan::FilmLayout>& layouts_;
  mechanics::StepCost cost_;
  mechanics::FilmCells cells_;
  std::unique_ptr<mechanics::TissueSystem> system_;  ///< null without tissue, as factor_ and forces_
  std::unique_ptr<mechanics::HeldFactor> factor_;
  std::unique_ptr<ResidualForce> forces_;
  std::unique_ptr<mechanics::FilmGeometry> geometry_;
  std::unique_ptr<FilmStep> films_;
  Predictor predictor_;
  coupling::FilmSolution solution_;  ///< of the iteration under way
  Eigen::VectorXd residual_;         ///< force without that of the films [N] (n_dofs)
  /// Vectors that every iteration writes into.
  struct Iteration {
    Eigen::VectorXd pressure;              ///< of cells on tissue [Pa]
    Eigen::VectorXd force;                 ///< that a solve starts from [N] (n_dofs)
    Eigen::VectorXd response;              ///< of the gaps on tissue [m3]
    Eigen::VectorXd displacement;          ///< [m] (n_dofs)
    Eigen::VectorXd gap_without_pressure;  ///< [m3] (cells of all films)
  };
  Iteration iteration_;
};

}  // namespace lipofill::step
