#include "core/equilibrium/solver.h"

#include <limits>

#include "absl/strings/str_cat.h"

namespace lipofill::equilibrium {
namespace {

constexpr int kMaxIterations = 80;
/// An iteration that leaves more of the error than this is slow; so many of them call for a factor.
constexpr double kSlowGain = 0.55;
constexpr int kMaxSlowIterations = 3;
/// An error that grows by more than this is going astray.
constexpr double kGrowth = 3.0;
/// Rounds of the active sets, and those after which cells only close.
constexpr int kMaxSetChanges = 40;
constexpr int kOpeningSetChanges = 20;
/// Rounds that make volumes exact: each squares what is left.
constexpr int kMaxVolumeRounds = 6;
constexpr double kVolumeRoundOff = 1e-13;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

bool Solver::solve(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance, Shape& shape) {
  springs_ = springs;
  reason_.clear();
  bring_to(shape);
  if (!response_.has_factor() && !renew()) return false;
  for (int change = 0; change < kMaxSetChanges; ++change) {
    if (!iterate(target, tolerance, shape) || !make_volumes_exact(target, shape)) return false;
    if (measure(target, tolerance, shape) > 1.0) continue;
    if (!update_active_sets(balance_, pools_, target, change < kOpeningSetChanges, shape)) return true;
    bring_to(shape);
  }
  reason_ = "the cells whose walls touch go on changing";
  return false;
}

/// Iterates with the active sets as they are. The balance is at `shape` before and after.
bool Solver::iterate(const PoolTarget& target, double tolerance, Shape& shape) {
  if (measure(target, tolerance, shape) <= 1.0) return true;
  mixing_.leap();
  if (volume_error_ > balance_.relative_force()) {
    // A step brings the volumes in, and forces out of balance: what was before tells nothing.
    if (!advance(shape)) return false;
    mixing_.reset();
  }
  Shape best = shape;
  double best_error = kInfinity, last_error = kInfinity;
  int slow = 0;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double error = measure(target, tolerance, shape);
    if (error <= 1.0) return true;
    if (error < best_error) {
      best = shape;
      best_error = error;
    }
    slow += error > kSlowGain * last_error;
    const bool grows = !(error <= kGrowth * last_error);
    const bool is_far = iteration == 0 && error * tolerance > kFarShare;
    last_error = error;
    if ((is_far && response_.is_late(balance_)) || grows || slow >= kMaxSlowIterations) {
      if (grows) {
        shape = best;
        bring_to(shape);
        last_error = measure(target, tolerance, shape);
      }
      if (!response_.is_late(balance_)) break;
      if (!renew()) return false;
      slow = 0;
      last_error = kInfinity;
    }
    if (!advance(shape)) break;
  }
  shape = best;
  bring_to(shape);
  if (reason_.empty()) reason_ = absl::StrCat("forces stay ", best_error, " times further from balance than they may");
  return false;
}

bool Solver::advance(Shape& shape) {
  if (!response_.correct(balance_, shape, missing_, dx_, dp_)) {
    reason_ = "the pools' pressures have no solution";
    return false;
  }
  const Eigen::Index n = dx_.size();
  unknowns_.resize(n + shape.n_rows());
  correction_.resize(unknowns_.size());
  unknowns_ << shape.displacement, shape.pressure;
  correction_ << dx_, dp_;
  mixing_.mix(unknowns_, correction_, n, next_);
  shape.displacement = next_.head(n);
  shape.pressure = next_.tail(shape.n_rows());
  ++cost_.iterations;
  bring_to(shape);
  return true;
}

bool Solver::renew() {
  ++cost_.factors;
  mixing_.reset();
  if (response_.renew(balance_, springs_)) return true;
  reason_ = "the tissue's stiffness is not positive definite";
  return false;
}

void Solver::bring_to(const Shape& shape) {
  balance_.bring_to(shape, springs_);
}

/// Tells how far forces and volumes are from balance, in tolerances; infinity for a folded tissue.
double Solver::measure(const PoolTarget& target, double tolerance, const Shape& shape) {
  missing_ = find_missing(balance_, pools_, target, shape);
  volume_error_ = relative_lack(pools_, target, shape, missing_);
  if (balance_.is_folded()) return kInfinity;
  return std::max(balance_.relative_force(), volume_error_) / tolerance;
}

/// Newton's iteration on the volumes alone, along the held response; forces follow in the end.
bool Solver::make_volumes_exact(const PoolTarget& target, Shape& shape) {
  const double round_off = kVolumeRoundOff * target.volume.cwiseAbs().sum();
  bool has_moved = false, is_exact = false;
  for (int round = 0; round < kMaxVolumeRounds; ++round) {
    missing_ = find_missing(balance_, pools_, target, shape);
    Eigen::VectorXd volumes = missing_;
    for (int pool = 0; pool < pools_.n(); ++pool) {
      if (shape.is_at_limit[static_cast<size_t>(pool)]) volumes[pool] = 0.0;
    }
    is_exact = volumes.cwiseAbs().sum() <= round_off;
    if (is_exact || !response_.correct_volumes(balance_, shape, missing_, dx_, dp_)) break;
    shape.displacement += dx_;
    shape.pressure += dp_;
    balance_.bring_gaps_to(shape);
    has_moved = true;
  }
  if (has_moved) balance_.bring_forces_to_gaps(shape, springs_);
  if (is_exact) return true;
  if (balance_.is_folded()) reason_ = "a hexahedron of the tissue is turned inside out";
  return reason_.empty();
}

}  // namespace lipofill::equilibrium
