// Opening the tissue for the films' initial thickness, by load stepping.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/step/coupled_step.h"

namespace lipofill::step {
namespace {

constexpr int kOpeningLoadSteps = 8;
constexpr int kMaxOpeningIterations = 40;
constexpr double kOpeningTolerance = 1e-8;
constexpr double kIntermediateOpeningTolerance = 1e-3;
/// Opening is quasi-static: inertia over this long a step only keeps S regular [s].
constexpr double kOpeningStep = 1.0;
constexpr int kMaxProducts = 300;
constexpr double kProductTolerance = 1e-9;
constexpr double kLeastLumpedShare = 1e-3;

/// p with C p = opening, by conjugate gradients preconditioned by diag(C 1).
bool open_by_products(coupling::CoupledFactor& factor, const Eigen::VectorXd& opening, Eigen::VectorXd& p) {
  const Eigen::VectorXd& lumped = factor.lumped_compliance();
  const double least = kLeastLumpedShare * lumped.cwiseAbs().maxCoeff();
  Eigen::VectorXd residual = opening, product;
  Eigen::VectorXd conditioned = residual.cwiseQuotient(lumped.cwiseMax(least));
  Eigen::VectorXd direction = conditioned;
  p.setZero(opening.size());
  double descent = residual.dot(conditioned);
  for (int k = 0; k < kMaxProducts; ++k) {
    if (residual.norm() <= kProductTolerance * opening.norm()) return true;
    factor.multiply_compliance(direction, product);
    const double share = descent / direction.dot(product);
    p += share * direction;
    residual -= share * product;
    conditioned = residual.cwiseQuotient(lumped.cwiseMax(least));
    const double next = residual.dot(conditioned);
    direction = conditioned + (next / descent) * direction;
    descent = next;
  }
  return false;
}

}  // namespace

/// Newton iterations on equilibrium with every cell holding `target`; false when they do not converge.
bool CoupledStep::open_to(const Eigen::VectorXd& target, double tolerance, mechanics::SimulationState& state,
                          Eigen::VectorXd& pressure) {
  for (int iteration = 0; iteration < kMaxOpeningIterations; ++iteration) {
    if (!linearise_tissue(state, kOpeningStep, coupling::Precision::kDouble)) return false;
    // From the present positions at rest: no inertia and no damping, weight and internal force only.
    Eigen::VectorXd force, response, dx;
    compute_residual_force(state, state.positions, kOpeningStep, force);
    factor_->solve_gap_response(force, response);
    const Eigen::VectorXd opening = target - gaps_->volume() - response;
    if (factor_->has_compliance()) {
      pressure = factor_->compliance().llt().solve(opening);
    } else if (!open_by_products(*factor_, opening, pressure)) {
      return false;
    }
    factor_->solve_displacement(pressure, dx);
    add_displacement(dx, state.positions);
    if (!state.positions.allFinite()) return false;
    gaps_->evaluate(state.positions);
    const double gap_error = (target - gaps_->volume()).cwiseAbs().sum() / target.cwiseAbs().sum();
    const double moved = (state.positions - tissue_->tissue.mesh().rest_positions).cwiseAbs().maxCoeff();
    if (gap_error <= tolerance && dx.cwiseAbs().maxCoeff() <= 10.0 * tolerance * moved) return true;
  }
  return false;
}

absl::Status CoupledStep::open_to_initial_thickness(mechanics::SimulationState& state) {
  Eigen::VectorXd initial(cell_offset_.back());
  for (size_t f = 0; f < films_.size(); ++f) {
    for (int cell = 0; cell < films_[f].grid.n_cells(); ++cell) {
      const geometry::ChartPoint centre = films_[f].cell_centre(cell);
      initial[cell_offset_[f] + cell] = rest_area_[f][cell] * films_[f].initial_thickness.at(centre.xi, centre.eta);
    }
    const int n = films_[f].grid.n_cells();
    state.films[f].volume = initial.segment(cell_offset_[f], n);
    for (Eigen::Index cell = 0; cell < state.films[f].is_entered.size(); ++cell) {
      const bool is_open = initial[cell_offset_[f] + cell] > rest_volume_[cell_offset_[f] + cell];
      state.films[f].is_entered[cell] = static_cast<double>(is_open);
    }
    if (films_[f].wall != plan::FilmWallKind::kWinkler) continue;
    state.films[f].pressure = films_[f].wall_stiffness *
                              (state.films[f].volume - rest_volume_.segment(cell_offset_[f], films_[f].grid.n_cells()))
                                  .cwiseQuotient(rest_area_[f]);
  }
  Eigen::VectorXd opening;
  gather_tissue_part(initial - rest_volume_, opening);
  if (opening.size() == 0 || opening.cwiseAbs().maxCoeff() == 0.0) return absl::OkStatus();
  Eigen::VectorXd pressure;
  for (int load = 1; load <= kOpeningLoadSteps; ++load) {
    const double tolerance = load == kOpeningLoadSteps ? kOpeningTolerance : kIntermediateOpeningTolerance;
    if (open_to(opening * load / kOpeningLoadSteps, tolerance, state, pressure)) continue;
    return field_violation(
        "films", absl::StrCat("initial_thickness_mm opens the tissue further than it can go: no equilibrium at ",
                              100 * load / kOpeningLoadSteps, " % of it"));
  }
  for (size_t k = 0; k < cell_of_tissue_.size(); ++k) {
    const auto f =
        std::upper_bound(cell_offset_.begin(), cell_offset_.end(), cell_of_tissue_[k]) - cell_offset_.begin() - 1;
    state.films[f].pressure[cell_of_tissue_[k] - cell_offset_[f]] = pressure[k];
  }
  return absl::OkStatus();
}

}  // namespace lipofill::step
