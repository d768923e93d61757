#include "core/step/initial_opening.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"

namespace lipofill::step {
namespace {

constexpr int kOpeningLoadSteps = 8;
constexpr int kMaxOpeningIterations = 40;
constexpr double kOpeningTolerance = 1e-8;
constexpr double kIntermediateOpeningTolerance = 1e-3;
constexpr int kMaxFillings = 40;
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

/// Fills every film to its initial thickness over cells of the areas that the positions of `state`
/// give them. Returns the volumes of all cells [m3].
Eigen::VectorXd fill(const Opening& opening, mechanics::SimulationState& state) {
  const mechanics::FilmCells& cells = opening.cells;
  Eigen::VectorXd initial(cells.n());
  for (size_t f = 0; f < opening.films.size(); ++f) {
    const plan::FilmLayout& layout = opening.films[f];
    const Eigen::VectorXd area = opening.geometry.metric_at(f, state.positions).area;
    mechanics::FilmState& film = state.films[f];
    auto volume = initial.segment(cells.offset[f], cells.n_of(f));
    for (int cell = 0; cell < cells.n_of(f); ++cell) {
      const geometry::ChartPoint centre = layout.cell_centre(cell);
      const double thickness = layout.initial_thickness.at(centre.xi, centre.eta);
      volume[cell] = area[cell] * thickness;
      if (film.is_entered.size() == 0) continue;
      film.is_entered[cell] = static_cast<double>(thickness > layout.rest_thickness.at(centre.xi, centre.eta));
    }
    film.volume = volume;
    if (layout.wall != plan::FilmWallKind::kWinkler) continue;
    const auto rest = opening.rest_volume.segment(cells.offset[f], cells.n_of(f));
    film.pressure = layout.wall_stiffness * (film.volume - rest).cwiseQuotient(area);
  }
  return initial;
}

/// True when no cell's volume differs from another by more than the tolerance of its thickness.
bool is_as_thick(const Eigen::VectorXd& volume, const Eigen::VectorXd& asked_for) {
  return ((volume - asked_for).array().abs() <= kThicknessTolerance * asked_for.array().abs()).all();
}

absl::Status opens_too_far(double share) {
  return field_violation(
      "films", absl::StrCat("initial_thickness_mm opens the tissue further than it can go: no equilibrium at ",
                            100.0 * share, " % of it"));
}

}  // namespace

absl::Status open_to_initial_thickness(const Opening& opening, mechanics::SimulationState& state) {
  const mechanics::FilmCells& cells = opening.cells;
  Eigen::VectorXd volume = fill(opening, state);
  Eigen::VectorXd target;
  cells.gather_tissue_part(volume - opening.rest_volume, target);
  if (target.size() == 0 || target.cwiseAbs().maxCoeff() == 0.0) return absl::OkStatus();
  Eigen::VectorXd pressure;
  for (int load = 1; load <= kOpeningLoadSteps; ++load) {
    const double share = static_cast<double>(load) / kOpeningLoadSteps;
    if (!open_to(opening, target * share, kIntermediateOpeningTolerance, state, pressure)) return opens_too_far(share);
  }
  // The walls have stretched: the same thickness is another volume now.
  for (int filling = 0;; ++filling) {
    if (filling == kMaxFillings) return opens_too_far(1.0);
    cells.gather_tissue_part(volume - opening.rest_volume, target);
    if (!open_to(opening, target, kOpeningTolerance, state, pressure)) return opens_too_far(1.0);
    Eigen::VectorXd asked_for = fill(opening, state);
    if (is_as_thick(volume, asked_for)) break;
    volume = std::move(asked_for);
  }
  for (size_t f = 0; f < opening.films.size(); ++f) {
    state.films[f].volume = volume.segment(cells.offset[f], cells.n_of(f));
  }
  for (size_t k = 0; k < cells.on_tissue.size(); ++k) {
    const int f = cells.film_of(cells.on_tissue[k]);
    state.films[f].pressure[cells.on_tissue[k] - cells.offset[f]] = pressure[static_cast<Eigen::Index>(k)];
  }
  return absl::OkStatus();
}

}  // namespace lipofill::step
