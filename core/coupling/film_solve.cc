#include "core/coupling/film_solve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lipofill::coupling {
namespace {

constexpr int kMaxIterations = 60;
/// An edge of hardly any flow between thick and thin cells may turn round in every iteration; one
/// that has turned so often goes on in its direction. Its flow is then too small to matter, or the
/// volume of a cell turns negative and the step is refused.
constexpr int kMaxTurns = 2;
constexpr int kUndampedIterations = 20;

/// Rounding error of a volume, as a share of the fullest cell's: a cell that holds no less than
/// minus this is empty.
constexpr double kRoundOff = 1e-10;

constexpr int kMaxNewtonIterations = 60;
constexpr int kMaxLineSearch = 30;
/// While the thickness is still far from settled, pressures need not be better than this share of
/// its change.
constexpr double kEarlyShare = 1e-3;
constexpr double kEarlyTolerance = 1e-6;
/// Share of the allowed mismatch that conjugate gradients may leave.
constexpr double kIterativeShare = 0.2;
/// A step along Newton's direction is taken once it has used up this share of the descent.
constexpr double kSlopeShare = 0.8;

double find_fullest(const Eigen::VectorXd& volume) {
  return std::max(volume.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
}

}  // namespace

FilmSolver::FilmSolver(std::vector<film::FilmProjection*> films) : films_(films), solver_(std::move(films)) {}

void FilmSolver::begin_directions(const FilmSolution& solution) {
  direction_ = solution.flux;
  turns_.resize(films_.size());
  for (size_t f = 0; f < films_.size(); ++f) turns_[f].setZero(direction_[f].size());
}

void FilmSolver::turn_directions(const FilmSolution& solution) {
  for (size_t f = 0; f < films_.size(); ++f) {
    const Eigen::VectorXd& flux = solution.flux[f];
    if (direction_[f].size() != flux.size()) {
      direction_[f] = flux;
      turns_[f].setZero(flux.size());
    }
    for (Eigen::Index e = 0; e < flux.size(); ++e) {
      const bool turns = (flux[e] >= 0.0) != (direction_[f][e] >= 0.0);
      if (!turns || turns_[f][e] == kMaxTurns) continue;
      direction_[f][e] = flux[e];
      ++turns_[f][e];
    }
  }
}

void FilmSolver::set_thickness(const Eigen::VectorXd& volume) {
  int offset = 0;
  for (size_t f = 0; f < films_.size(); ++f) {
    films_[f]->set_thickness(volume.segment(offset, films_[f]->grid().n_cells()), direction_[f]);
    offset += films_[f]->grid().n_cells();
  }
}

void FilmSolver::measure_mobility(const FilmSolution& at, std::vector<Eigen::VectorXd>& mobility) {
  direction_ = at.flux;
  set_thickness(at.volume);
  mobility.resize(films_.size());
  int offset = 0;
  for (size_t f = 0; f < films_.size(); ++f) {
    const int n = films_[f]->grid().n_cells();
    mobility[f] = films_[f]->linearise(at.pressure.segment(offset, n)).coeffs();
    offset += n;
  }
}

void FilmSolver::solve(const Eigen::VectorXd& gap_without_pressure, const Eigen::VectorXd& lowest,
                       FilmTolerance tolerance, FilmSolution& solution) {
  gap_ = &gap_without_pressure;
  lowest_ = &lowest;
  is_linear_ = std::all_of(films_.begin(), films_.end(), [](const auto* film) { return film->is_linear(); });
  held_.assign(gap_->size(), 0);
  guess_ = solution.volume;
  begin_directions(solution);
  solver_.multiply_walls(solution.pressure, moved_);
  solution.converged = false;
  solution.change = std::numeric_limits<double>::infinity();
  for (solution.iterations = 1; solution.iterations <= kMaxIterations; ++solution.iterations) {
    if (solution.iterations > 1) turn_directions(solution);
    set_thickness(guess_);
    const double early = std::min(kEarlyShare * solution.change, kEarlyTolerance);
    if (!solve_pressure(std::max(tolerance.mismatch, early), solution)) break;
    const double fullest = find_fullest(solution.volume);
    solution.change = (solution.volume - guess_).cwiseAbs().maxCoeff() / fullest;
    if (solution.change <= tolerance.change && is_exact(tolerance.mismatch, solution)) {
      solution.converged = solution.volume.minCoeff() >= -kRoundOff * fullest;
      const bool may_be_tolerance = tolerance.change > FilmTolerance().change;
      if (solution.converged || !may_be_tolerance) break;
      tolerance = FilmTolerance();
    }
    const double blend = solution.iterations < kUndampedIterations ? 1.0 : 0.5;
    guess_ += blend * (solution.volume - guess_);
  }
}

/// True when the mismatch is within the tolerance with C p computed anew: solves of many cells only
/// update it by its changes.
bool FilmSolver::is_exact(double tolerance, FilmSolution& solution) {
  if (!solver_.is_lagged()) return true;
  solver_.multiply_walls(solution.pressure, moved_);
  residual_ = solution.volume - *gap_ - moved_;
  return mismatch(solution.volume) <= tolerance;
}

/// Solves for the pressures at fixed thickness: improves `solution.pressure`; volume, void and flux
/// follow. False when it cannot.
bool FilmSolver::solve_pressure(double tolerance, FilmSolution& solution) {
  if (has_limit()) {
    solution.pressure = solution.pressure.cwiseMax(*lowest_);
    solver_.multiply_walls(solution.pressure, moved_);
  }
  evaluate(solution);
  double last = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < kMaxNewtonIterations; ++iteration) {
    hold_cells_at_the_limit(solution.pressure);
    const double error = mismatch(solution.volume);
    const bool is_at_round_off = error <= 100.0 * tolerance && error > 0.5 * last;
    if (error <= tolerance || is_at_round_off) {
      measure_void(solution);
      return true;
    }
    last = error;
    const double may_be_left = kIterativeShare * tolerance * find_fullest(solution.volume);
    if (!solver_.solve(solution.pressure, held_, residual_, may_be_left, step_, moved_step_)) return false;
    advance(solution);
    if (!residual_.allFinite()) return false;
  }
  return false;
}

/// Computes fluxes and volumes at solution.pressure, and what the gap lacks: r = V' - g0 - C p.
void FilmSolver::evaluate(FilmSolution& solution) {
  Eigen::Index offset = 0;
  for (size_t f = 0; f < films_.size(); ++f) {
    const int n = films_[f]->grid().n_cells();
    films_[f]->compute_flux(solution.pressure.segment(offset, n), solution.flux[f]);
    films_[f]->compute_volume(solution.flux[f], solution.volume.segment(offset, n));
    offset += n;
  }
  residual_ = solution.volume - *gap_ - moved_;
}

/// Marks the cells that are held: at the limit, and with a gap that would rather be wider than the
/// fat fills.
void FilmSolver::hold_cells_at_the_limit(const Eigen::VectorXd& p) {
  if (!has_limit()) return;
  for (Eigen::Index i = 0; i < p.size(); ++i) held_[i] = p[i] <= (*lowest_)[i] && residual_[i] <= 0.0;
}

double FilmSolver::mismatch(const Eigen::VectorXd& volume) const {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < residual_.size(); ++i) {
    largest = std::max(largest, held_[i] ? 0.0 : std::abs(residual_[i]));
  }
  return largest / find_fullest(volume);
}

void FilmSolver::measure_void(FilmSolution& solution) const {
  solution.void_volume.setZero(residual_.size());
  for (Eigen::Index i = 0; i < residual_.size(); ++i) {
    if (held_[i]) solution.void_volume[i] = std::max(0.0, -residual_[i]);
  }
}

/// Moves to the pressure start + share dp, but no lower than the limit.
void FilmSolver::go(double share, FilmSolution& solution) {
  solution.pressure = start_ + share * step_;
  if (has_limit()) {
    solution.pressure = solution.pressure.cwiseMax(*lowest_);
    solver_.multiply_walls(solution.pressure, moved_);
  } else {
    moved_ = moved_start_ + share * moved_step_;
  }
  evaluate(solution);
}

/// Goes along dp until the convex function stops falling; its slope there is -r . dp.
void FilmSolver::advance(FilmSolution& solution) {
  start_ = solution.pressure;
  moved_start_ = moved_;
  const double slope_at_start = residual_.dot(step_);
  go(1.0, solution);
  if (is_linear_) return;
  double low = 0.0, low_slope = -slope_at_start, high = 1.0;
  for (int trial = 0; trial < kMaxLineSearch; ++trial) {
    const double slope = -residual_.dot(step_);
    if (slope <= kSlopeShare * slope_at_start) return;
    const double secant = low + (high - low) * low_slope / (low_slope - slope);
    const double share = std::clamp(secant, low + 0.05 * (high - low), low + 0.7 * (high - low));
    high = share;
    go(share, solution);
    if (-residual_.dot(step_) < 0.0) return;
  }
}

}  // namespace lipofill::coupling
