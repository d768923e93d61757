#include "core/simulation/ensemble_ground.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/geometry/hex_quality.h"
#include "core/model/thicker_model.h"
#include "core/plan/plan_placement.h"

namespace lipofill::simulation {

using Eigen::VectorXd;

namespace {

/// A hexahedron with less is folded, or about to be (geometry/hex_quality.h).
constexpr double kLeastJacobian = 0.02;

}  // namespace

absl::Status make_ground(const model::FaceModel& model, const plan::SimulationSpec& spec, Ground& ground,
                         plan::InjectionSchedule& schedule) {
  plan::PlacedPlan placed;
  if (const absl::Status status = plan::place_plan(model, spec, nullptr, placed); !status.ok()) return status;
  ground.films = std::move(placed.films);
  schedule = std::move(placed.schedule);
  auto stepper = step::CoupledStep::create(model, ground.films, spec);
  if (!stepper.ok()) return stepper.status();
  ground.stepper = *std::move(stepper);
  ground.rest = ground.stepper->rest_state();
  if (const absl::Status open = ground.stepper->open_to_initial_thickness(ground.rest); !open.ok()) return open;
  // When a run of the plan would end does not matter to a shape at rest.
  plan::SimulationSpec at_rest = spec;
  at_rest.settle_skin_speed = std::max(at_rest.settle_skin_speed, std::numeric_limits<double>::min());
  at_rest.end = std::numeric_limits<double>::infinity();
  const auto hindrance =
      DirectShape::find_hindrance(model, ground.films, at_rest, schedule, ground.rest, *ground.stepper, false);
  if (hindrance) {
    return absl::FailedPreconditionError(absl::StrCat(
        "the settled shape of this plan cannot be found at once, which a forecast needs: ", hindrance->text()));
  }
  auto direct = DirectShape::create(model, ground.films, spec, *ground.stepper, ground.rest);
  if (!direct.ok()) return direct.status();
  ground.direct = *std::move(direct);
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<OtherTissue>> make_tissue(const Ground& ground, const model::FaceModel& model,
                                                         const plan::SimulationSpec& spec, const VectorXd& thickness) {
  auto other = std::make_unique<OtherTissue>();
  other->model = model::with_thickness(model, thickness);
  const geometry::WorstHexahedron worst = geometry::find_worst_hexahedron(other->model->geometry.grid);
  if (worst.scaled_jacobian < kLeastJacobian) {
    return absl::FailedPreconditionError("layers of that thickness fold where the face is curved");
  }
  const mechanics::FilmCells& cells = ground.stepper->cells();
  auto system = mechanics::TissueSystem::create(*other->model, ground.films, cells, spec, other->cost);
  if (!system.ok()) return system.status();
  other->system = *std::move(system);
  other->geometry =
      std::make_unique<mechanics::FilmGeometry>(other->model->geometry.grid, ground.films, cells, other->system.get());
  auto equilibrium = equilibrium::Equilibrium::create(*other->model, ground.films, cells, *other->system,
                                                      *other->geometry, {spec.gravity, spec.fat_density}, other->cost);
  if (!equilibrium.ok()) return equilibrium.status();
  other->equilibrium = *std::move(equilibrium);
  return other;
}

std::vector<VectorXd> find_injected(const Ground& ground, const model::FaceModel& model,
                                    const plan::SimulationSpec& spec, const plan::InjectionSchedule& schedule) {
  std::vector<VectorXd> injected;
  const mechanics::FilmCells& cells = ground.stepper->cells();
  for (const plan::InjectionSpec& injection : spec.injections) {
    const auto placed = schedule.place(model, ground.films, injection, 0.0);
    VectorXd all = VectorXd::Zero(cells.n()), on_tissue;
    for (size_t k = 0; placed.ok() && k < placed->cells.size(); ++k) {
      all[cells.offset[static_cast<size_t>(placed->film)] + placed->cells[k]] += injection.volume * placed->shares[k];
    }
    cells.gather_tissue_part(all, on_tissue);
    injected.push_back(ground.direct->equilibrium().pools().sum(on_tissue));
  }
  return injected;
}

}  // namespace lipofill::simulation
