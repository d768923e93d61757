#include "core/forecast/grid_error.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/simulation/discretisation.h"
#include "core/simulation/half_grid.h"
#include "core/simulation/simulation.h"

namespace lipofill::forecast {
namespace {

using simulation::DiscretisationError;
using simulation::Phase;
using simulation::Simulation;

constexpr double kTakenOrder = 1.5;  // that of the extrapolation
constexpr double kLeastOrder = 1.0;
constexpr double kMostOrder = 4.0;
constexpr double kNextToNothing = 0.002;
constexpr uint64_t kMostSteps = 400;

absl::StatusOr<std::unique_ptr<Simulation>> settle(const std::shared_ptr<const model::FaceModel>& model,
                                                   plan::SimulationSpec plan) {
  plan.goal = plan::TimeGoal::kSettledShape;
  auto simulation = Simulation::create(model, std::move(plan));
  if (!simulation.ok()) return simulation;
  while ((*simulation)->phase() == Phase::kRunning && (*simulation)->report().step < kMostSteps) {
    (*simulation)->advance_step();
  }
  if ((*simulation)->phase() == Phase::kSettled) return simulation;
  return absl::FailedPreconditionError(absl::StrCat("the plan does not come to rest in ", kMostSteps, " steps"));
}

std::optional<double> observed_order(double error, double coarser_error, double ratio) {
  if (!(error > 0.0) || !(coarser_error > 0.0)) return std::nullopt;
  return std::log(coarser_error / error) / std::log(ratio);
}

bool holds(const std::optional<double>& order, double difference) {
  return difference < kNextToNothing || (order && *order >= kLeastOrder && *order <= kMostOrder);
}

std::string order_text(const std::optional<double>& order) {
  return order ? absl::StrFormat("%.1f", *order) : "not known";
}

}  // namespace

absl::StatusOr<GridError> estimate_grid_error(const std::shared_ptr<const model::FaceModel>& model,
                                              const plan::SimulationSpec& plan) {
  const auto fine = settle(model, plan);
  if (!fine.ok()) return fine.status();
  const auto estimate = simulation::estimate_discretisation_error(**fine);
  if (!estimate.ok()) return estimate.status();
  const auto coarse = simulation::settle_on_half_grid(**fine);
  if (!coarse.ok()) return coarse.status();
  const double ratio = simulation::ratio_of_widths(**fine, **coarse);
  const double to_difference = std::pow(ratio, kTakenOrder) - 1.0;
  GridError error{estimate->lift, estimate->pressure, estimate->skin, {}, {}, false};
  // A grid too coarse to be halved once more leaves the order unknown.
  if (const auto coarser = simulation::estimate_discretisation_error(**coarse); coarser.ok()) {
    error.lift_order = observed_order(estimate->lift, coarser->lift, ratio);
    error.pressure_order = observed_order(estimate->pressure, coarser->pressure, ratio);
  }
  error.order_holds = holds(error.lift_order, to_difference * error.lift) &&
                      holds(error.pressure_order, to_difference * error.pressure);
  if (error.order_holds) return error;
  for (double* part : {&error.lift, &error.pressure, &error.skin}) *part *= to_difference;
  return error;
}

std::string remark_on_order(const GridError& error) {
  if (error.order_holds) return "";
  return absl::StrFormat(
      "Over three grids the error does not fall with the order that an extrapolation takes (lift: order %s, pressure: "
      "order %s, for 1 to 4): what is told of the grid is the plain difference of two; raise n_xi and n_eta of the "
      "model.",
      order_text(error.lift_order), order_text(error.pressure_order));
}

}  // namespace lipofill::forecast
