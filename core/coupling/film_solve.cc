#include "core/coupling/film_solve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lipofill::coupling {
namespace {

constexpr int kMaxIterations = 60;
/// An edge of hardly any flow between thick and thin cells may turn round in every iteration; from here on each keeps
/// its direction. Its flow is then too small to matter, or the volume of a cell turns negative and the step is refused.
constexpr int kFreeDirectionIterations = 12;
constexpr int kUndampedIterations = 20;
constexpr double kTolerance = 1e-10;

constexpr int kMaxNewtonIterations = 60;
constexpr int kMaxLineSearch = 30;
/// Largest mismatch of a cell's gap and volume, relative to the fullest cell.
constexpr double kPressureTolerance = 1e-11;
/// While the thickness is still far from settled, pressures need not be better than this share of its change.
constexpr double kEarlyTolerance = 1e-3;
/// A step along Newton's direction is taken once it has used up this share of the descent.
constexpr double kSlopeShare = 0.8;

/// Pressures of all films at fixed thickness.
class PressureProblem {
 public:
  PressureProblem(const std::vector<film::FilmProjection*>& films, const WallCompliance& walls,
                  const Eigen::VectorXd& gap_without_pressure, const Eigen::VectorXd& lowest)
      : films_(films),
        walls_(walls),
        gap_(gap_without_pressure),
        lowest_(lowest),
        solver_(films, walls, static_cast<int>(gap_without_pressure.size())),
        held_(gap_without_pressure.size(), 0) {
    for (const film::FilmProjection* film : films) is_linear_ = is_linear_ && film->is_linear();
  }

  /// Improves `result.pressure`; volume, void and flux follow. False: it cannot.
  bool solve(double tolerance, FilmSolveResult& result) {
    if (has_limit()) result.pressure = result.pressure.cwiseMax(lowest_);
    Eigen::VectorXd r = evaluate(result);
    double last = std::numeric_limits<double>::infinity();
    for (int iteration = 0; iteration < kMaxNewtonIterations; ++iteration) {
      hold_cells_at_the_limit(result.pressure, r);
      const double error = mismatch(r, result.volume);
      if (error <= tolerance) return keep_void(r, result);
      const bool at_round_off = error <= 100.0 * tolerance && error > 0.5 * last;
      if (at_round_off) return keep_void(r, result);
      last = error;
      Eigen::VectorXd dp;
      if (!solver_.solve(result.pressure, held_, r, dp)) return false;
      r = advance(dp, r, result);
      if (!r.allFinite()) return false;
    }
    return false;
  }

 private:
  bool has_limit() const { return lowest_.size() > 0; }

  /// Fluxes and volumes at result.pressure, and what the gap lacks: r = V' - g0 - C p.
  Eigen::VectorXd evaluate(FilmSolveResult& result) const {
    Eigen::Index offset = 0;
    for (size_t f = 0; f < films_.size(); ++f) {
      const int n = films_[f]->grid().n_cells();
      result.flux[f] = films_[f]->compute_flux(result.pressure.segment(offset, n));
      result.volume.segment(offset, n) = films_[f]->compute_volume(result.flux[f]);
      offset += n;
    }
    return result.volume - gap_ - walls_.times(result.pressure);
  }

  /// Held: at the limit, and the gap would rather be wider than the fat fills.
  void hold_cells_at_the_limit(const Eigen::VectorXd& p, const Eigen::VectorXd& r) {
    if (!has_limit()) return;
    for (Eigen::Index i = 0; i < p.size(); ++i) held_[i] = p[i] <= lowest_[i] && r[i] <= 0.0;
  }

  double mismatch(const Eigen::VectorXd& r, const Eigen::VectorXd& volume) const {
    double largest = 0.0;
    for (Eigen::Index i = 0; i < r.size(); ++i) largest = std::max(largest, held_[i] ? 0.0 : std::abs(r[i]));
    return largest / std::max(volume.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
  }

  bool keep_void(const Eigen::VectorXd& r, FilmSolveResult& result) const {
    result.void_volume.setZero(r.size());
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      if (held_[i]) result.void_volume[i] = std::max(0.0, -r[i]);
    }
    return true;
  }

  /// Goes along dp until the convex function stops falling; its slope there is -r . dp. Returns the new r.
  Eigen::VectorXd advance(const Eigen::VectorXd& dp, const Eigen::VectorXd& r, FilmSolveResult& result) const {
    const Eigen::VectorXd start = result.pressure;
    const auto go = [&](double share) {
      result.pressure = start + share * dp;
      if (has_limit()) result.pressure = result.pressure.cwiseMax(lowest_);
      return evaluate(result);
    };
    Eigen::VectorXd next = go(1.0);
    if (is_linear_) return next;
    const double slope_at_start = r.dot(dp);
    double low = 0.0, low_slope = -slope_at_start, high = 1.0;
    for (int trial = 0; trial < kMaxLineSearch; ++trial) {
      const double slope = -next.dot(dp);
      if (slope <= kSlopeShare * slope_at_start) break;
      const double secant = low + (high - low) * low_slope / (low_slope - slope);
      const double share = std::clamp(secant, low + 0.05 * (high - low), low + 0.7 * (high - low));
      high = share;
      next = go(share);
      if (-next.dot(dp) < 0.0) break;
    }
    return next;
  }

  const std::vector<film::FilmProjection*>& films_;
  const WallCompliance& walls_;
  const Eigen::VectorXd& gap_;
  const Eigen::VectorXd& lowest_;
  PressureSolver solver_;
  std::vector<char> held_;
  bool is_linear_ = true;
};

void set_thickness(const std::vector<film::FilmProjection*>& films, const Eigen::VectorXd& volume,
                   const std::vector<Eigen::VectorXd>& flux) {
  int offset = 0;
  for (size_t f = 0; f < films.size(); ++f) {
    films[f]->set_thickness(volume.segment(offset, films[f]->grid().n_cells()), flux[f]);
    offset += films[f]->grid().n_cells();
  }
}

}  // namespace

FilmSolveResult solve_films(std::vector<film::FilmProjection*> films, const WallCompliance& walls,
                            const Eigen::VectorXd& gap_without_pressure, const Eigen::VectorXd& lowest,
                            const FilmSolveResult& start) {
  PressureProblem problem(films, walls, gap_without_pressure, lowest);
  FilmSolveResult result = start;
  result.converged = false;
  result.change = std::numeric_limits<double>::infinity();
  Eigen::VectorXd guess = start.volume;
  std::vector<Eigen::VectorXd> direction = start.flux;
  for (result.iterations = 1; result.iterations <= kMaxIterations; ++result.iterations) {
    if (result.iterations <= kFreeDirectionIterations) direction = result.flux;
    set_thickness(films, guess, direction);
    const double early = std::min(kEarlyTolerance * result.change, 1e-6);
    if (!problem.solve(std::max(kPressureTolerance, early), result)) break;
    const double fullest = std::max(result.volume.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
    result.change = (result.volume - guess).cwiseAbs().maxCoeff() / fullest;
    if (result.change <= kTolerance) {
      result.converged = result.volume.minCoeff() >= -kTolerance * fullest;
      break;
    }
    const double blend = result.iterations < kUndampedIterations ? 1.0 : 0.5;
    guess += blend * (result.volume - guess);
  }
  return result;
}

}  // namespace lipofill::coupling
