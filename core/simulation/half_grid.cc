#include "core/simulation/half_grid.h"

#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/plan/coarse_plan.h"

namespace lipofill::simulation {
namespace {

/// Widths nearer to each other than this tell nothing.
constexpr double kLeastRatio = 1.4;
constexpr uint64_t kMostSteps = 400;

absl::Status unknown(std::string why) {
  return absl::FailedPreconditionError(std::move(why));
}

double ratio_of_grids(const geometry::LayeredGrid& fine, const geometry::LayeredGrid& coarse) {
  return std::sqrt(static_cast<double>(fine.n_xi) * fine.n_eta / (static_cast<double>(coarse.n_xi) * coarse.n_eta));
}

}  // namespace

double ratio_of_widths(const Simulation& fine, const Simulation& coarse) {
  return ratio_of_grids(fine.model().geometry.grid, coarse.model().geometry.grid);
}

absl::StatusOr<std::unique_ptr<Simulation>> settle_on_half_grid(const Simulation& settled) {
  if (settled.phase() != Phase::kSettled) return unknown("the simulation has not settled");
  if (settled.model().layers.empty()) return unknown("the model has no tissue");
  std::shared_ptr<const model::FaceModel> model = plan::halve_model(settled.model());
  if (ratio_of_grids(settled.model().geometry.grid, model->geometry.grid) < kLeastRatio) {
    return unknown("the grid has too few divisions to be halved");
  }
  plan::SimulationSpec plan = plan::coarsen_plan(settled.spec(), settled.model(), *model);
  plan.error_tolerance = settled.spec().error_tolerance;
  auto coarse = Simulation::create(std::move(model), std::move(plan));
  if (!coarse.ok())
    return unknown(absl::StrCat("a grid half as fine cannot hold the plan: ", coarse.status().message()));
  while ((*coarse)->phase() == Phase::kRunning && (*coarse)->report().step < kMostSteps) (*coarse)->advance_step();
  if ((*coarse)->phase() == Phase::kSettled) return coarse;
  return unknown(absl::StrCat("on a grid half as fine the plan does not come to rest in ", kMostSteps, " steps"));
}

}  // namespace lipofill::simulation
