#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/equilibrium/ensemble.h"
#include "core/equilibrium/equilibrium.h"
#include "core/equilibrium/scope.h"
#include "core/plan/injection_schedule.h"
#include "core/step/coupled_step.h"

namespace lipofill::simulation {

/// The settled shape of a plan, found directly (core/equilibrium) in place of steps, with the parts
/// of its step. Checked by tests/unit/simulation/direct_shape_test.cc.
class DirectShape {
 public:
  /// The first field of the plan that forbids it, nothing where the settled shape can be found so.
  /// @param rest         the state that the plan begins with
  /// @param is_injected  all of it is in: what hinders until then is passed over
  static std::optional<equilibrium::Hindrance> find_hindrance(const model::FaceModel& model,
                                                              const std::vector<plan::FilmLayout>& films,
                                                              const plan::SimulationSpec& spec,
                                                              const plan::InjectionSchedule& schedule,
                                                              const mechanics::SimulationState& rest,
                                                              const step::CoupledStep& stepper, bool is_injected);

  /// For a plan that nothing forbids, or nothing once all is injected. Errors as
  /// Equilibrium::create. What is passed here outlives the shape, but for `from`.
  /// @param from  says which cells fat has entered: it enters no more
  static absl::StatusOr<std::unique_ptr<DirectShape>> create(const model::FaceModel& model,
                                                             const std::vector<plan::FilmLayout>& films,
                                                             const plan::SimulationSpec& spec,
                                                             step::CoupledStep& stepper,
                                                             const mechanics::SimulationState& from);

  /// Finds the shape with what a state at rest holds and what is injected beside it [m3] (a film,
  /// its cells), and writes it into `next`: positions, and volumes and pressures of the films;
  /// nothing moves. Where not all of it goes in, `next` has as much as does.
  equilibrium::Settled find(const mechanics::SimulationState& from, const std::vector<Eigen::VectorXd>& injected,
                            mechanics::SimulationState& next);
  /// The same from the last shape (Equilibrium::follow).
  equilibrium::Settled follow(const mechanics::SimulationState& from, const std::vector<Eigen::VectorXd>& injected,
                              mechanics::SimulationState& next);
  /// The first ligament that breaks at the last shape, where it holds until then.
  std::optional<std::string> find_breaking_ligament(const std::vector<mechanics::LigamentLayout>& ligaments) const;
  /// Members beside the shape with what is injected, whose own volumes and moduli are these.
  struct Members {
    equilibrium::Ensemble ensemble;
    Eigen::VectorXd volumes;  ///< of the pools, as MemberChange has them [m3]
  };
  Members begin_ensemble(const mechanics::SimulationState& from, const std::vector<Eigen::VectorXd>& injected);
  /// The same beside the shape whose pools hold so much [m3].
  equilibrium::Ensemble begin_ensemble(const mechanics::SimulationState& from, const Eigen::VectorXd& pool_volumes);
  /// Tells what the pools hold in a state with nothing injected [m3].
  Eigen::VectorXd pool_volumes(const mechanics::SimulationState& from) const;
  /// This finds them.
  equilibrium::Equilibrium& equilibrium() { return *equilibrium_; }

 private:
  DirectShape(const mechanics::FilmCells& cells, std::unique_ptr<equilibrium::Equilibrium> equilibrium,
              double lowest_head)
      : cells_(cells), equilibrium_(std::move(equilibrium)), lowest_head_(lowest_head) {}
  equilibrium::PoolTarget target_with(const mechanics::SimulationState& from,
                                      const std::vector<Eigen::VectorXd>& injected) const;
  void fill(const mechanics::SimulationState& from, const equilibrium::Settled& settled,
            mechanics::SimulationState& next) const;
  void fill_films(const equilibrium::Settled& settled, mechanics::SimulationState& next) const;

  const mechanics::FilmCells& cells_;
  std::unique_ptr<equilibrium::Equilibrium> equilibrium_;
  double lowest_head_;
};

}  // namespace lipofill::simulation
