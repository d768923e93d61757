#include "core/step/initial_opening.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"

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
/// Share of the largest C 1 that a cell's own counts for at least in the preconditioner.
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

/// Newton iterations on equilibrium with every cell holding `target`; false when they do not
/// converge.
bool open_to(const Opening& opening, const Eigen::VectorXd& target, double tolerance, mechanics::SimulationState& state,
             Eigen::VectorXd& pressure) {
  mechanics::TissueSystem& system = *opening.system;
  coupling::CoupledFactor& factor = opening.factor->factor();
  for (int iteration = 0; iteration < kMaxOpeningIterations; ++iteration) {
    if (!opening.factor->factor_at(state.positions, state.spring_is_intact, kOpeningStep, coupling::Precision::kDouble))
      return false;
    // A step that begins at the present positions, at rest, has weight and internal force only.
    Eigen::VectorXd force, response, dx;
    opening.forces->compute(state, state.positions, kOpeningStep, force);
    factor.solve_gap_response(force, response);
    const Eigen::VectorXd missing = target - system.gaps().volume() - response;
    if (factor.has_compliance()) {
      pressure = factor.compliance().llt().solve(missing);
    } else if (!open_by_products(factor, missing, pressure)) {
      return false;
    }
    factor.solve_displacement(pressure, dx);
    system.add_displacement(dx, state.positions);
    if (!state.positions.allFinite()) return false;
    system.evaluate_gaps(state.positions);
    const double gap_error = (target - system.gaps().volume()).cwiseAbs().sum() / target.cwiseAbs().sum();
    const double moved = (state.positions - system.rest_positions()).cwiseAbs().maxCoeff();
    if (gap_error <= tolerance && dx.cwiseAbs().maxCoeff() <= 10.0 * tolerance * moved) return true;
  }
  return false;
}

/// Fills every film to its initial thickness. Returns the volumes of all cells [m3].
Eigen::VectorXd fill(const Opening& opening, mechanics::SimulationState& state) {
  const mechanics::FilmCells& cells = opening.cells;
  Eigen::VectorXd initial(cells.n());
  for (size_t f = 0; f < opening.films.size(); ++f) {
    const plan::FilmLayout& layout = opening.films[f];
    const Eigen::VectorXd& area = opening.geometry.rest_area(f);
    mechanics::FilmState& film = state.films[f];
    auto volume = initial.segment(cells.offset[f], cells.n_of(f));
    const auto rest = opening.rest_volume.segment(cells.offset[f], cells.n_of(f));
    for (int cell = 0; cell < cells.n_of(f); ++cell) {
      const geometry::ChartPoint centre = layout.cell_centre(cell);
      volume[cell] = area[cell] * layout.initial_thickness.at(centre.xi, centre.eta);
    }
    film.volume = volume;
    for (Eigen::Index cell = 0; cell < film.is_entered.size(); ++cell) {
      film.is_entered[cell] = static_cast<double>(volume[cell] > rest[cell]);
    }
    if (layout.wall != plan::FilmWallKind::kWinkler) continue;
    film.pressure = layout.wall_stiffness * (film.volume - rest).cwiseQuotient(area);
  }
  return initial;
}

}  // namespace

absl::Status open_to_initial_thickness(const Opening& opening, mechanics::SimulationState& state) {
  const mechanics::FilmCells& cells = opening.cells;
  const Eigen::VectorXd initial = fill(opening, state);
  Eigen::VectorXd target;
  cells.gather_tissue_part(initial - opening.rest_volume, target);
  if (target.size() == 0 || target.cwiseAbs().maxCoeff() == 0.0) return absl::OkStatus();
  Eigen::VectorXd pressure;
  for (int load = 1; load <= kOpeningLoadSteps; ++load) {
    const double tolerance = load == kOpeningLoadSteps ? kOpeningTolerance : kIntermediateOpeningTolerance;
    if (open_to(opening, target * load / kOpeningLoadSteps, tolerance, state, pressure)) continue;
    return field_violation(
        "films", absl::StrCat("initial_thickness_mm opens the tissue further than it can go: no equilibrium at ",
                              100 * load / kOpeningLoadSteps, " % of it"));
  }
  for (size_t k = 0; k < cells.on_tissue.size(); ++k) {
    const int f = cells.film_of(cells.on_tissue[k]);
    state.films[f].pressure[cells.on_tissue[k] - cells.offset[f]] = pressure[static_cast<Eigen::Index>(k)];
  }
  return absl::OkStatus();
}

}  // namespace lipofill::step
