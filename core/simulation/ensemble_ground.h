#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "core/simulation/direct_shape.h"
#include "core/step/coupled_step.h"

namespace lipofill::simulation {

/// An ensemble of a plan (plan_ensemble.h) stands on the equations of the plan, and on those of
/// tissue that is thicker or thinner. Checked by tests/unit/simulation/plan_ensemble_test.cc.

/// The ground holds the plan's equations, at rest, and the ensemble beside one of its shapes.
struct Ground {
  std::vector<plan::FilmLayout> films;
  std::unique_ptr<step::CoupledStep> stepper;
  mechanics::SimulationState rest;
  std::unique_ptr<DirectShape> direct;
  std::unique_ptr<equilibrium::Ensemble> ensemble;
};

/// Places a plan and makes its equations. Errors as TrialShape::create.
absl::Status make_ground(const model::FaceModel& model, const plan::SimulationSpec& spec, Ground& ground,
                         plan::InjectionSchedule& schedule);

/// This is tissue whose layers are thicker or thinner than the model's, with all that a shape of it
/// needs.
struct OtherTissue {
  std::shared_ptr<const model::FaceModel> model;
  mechanics::StepCost cost;
  std::unique_ptr<mechanics::TissueSystem> system;
  std::unique_ptr<mechanics::FilmGeometry> geometry;
  std::unique_ptr<equilibrium::Equilibrium> equilibrium;
};

/// Makes the layers of a model thicker by a factor each. FAILED_PRECONDITION where they fold.
absl::StatusOr<std::unique_ptr<OtherTissue>> make_tissue(const Ground& ground, const model::FaceModel& model,
                                                         const plan::SimulationSpec& spec,
                                                         const Eigen::VectorXd& thickness);

/// Finds what each of the plan's injections puts into each pool [m3] (n_pools).
std::vector<Eigen::VectorXd> find_injected(const Ground& ground, const model::FaceModel& model,
                                           const plan::SimulationSpec& spec, const plan::InjectionSchedule& schedule);

}  // namespace lipofill::simulation
