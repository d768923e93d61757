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
/// After the first step the factor is of a shape far away where this share of the forces is left.
constexpr double kFarShare = 0.2;
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
  // The first step brings the volumes in, and forces out of balance: what was before tells nothing.
  mixing_.reset();
  if (!advance(shape)) return false;
  mixing_.reset();
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
    if (is_far || grows || slow >= kMaxSlowIterations) {
      if (grows) {
        shape = best;
        bring_to(shape);
        last_error = measure(target, tolerance, shape);
      }
      if (!response_.is_late(balance_)) break;
      if (!renew()) return false;
      mixing_.reset();
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
  if (response_.renew(balance_, springs_)) return true;
  reason_ = "the tissue's stiffness is not positive definite";
  return false;
}

void Solver::bring_to(const Shape& shape) {
  balance_.bring_to(shape, springs_);
}

/// How far forces and volumes are from balance, in tolerances; infinity for a folded tissue.
double Solver::measure(const PoolTarget& target, double tolerance, const Shape& shape) {
  missing_ = find_missing(balance_, pools_, target, shape);
  if (balance_.is_folded()) return kInfinity;
  double lacking = 0.0;
  for (int pool = 0; pool < pools_.n(); ++pool) {
    if (!shape.is_at_limit[static_cast<size_t>(pool)]) lacking += std::abs(missing_[pool]);
  }
  const double of_volume = lacking / std::max(target.volume.cwiseAbs().sum(), std::numeric_limits<double>::min());
  return std::max(balance_.relative_force(), of_volume) / tolerance;
}

/// Newton's iteration on the volumes alone, along the held response.
bool Solver::make_volumes_exact(const PoolTarget& target, Shape& shape) {
  const double round_off = kVolumeRoundOff * target.volume.cwiseAbs().sum();
  for (int round = 0; round < kMaxVolumeRounds; ++round) {
    missing_ = find_missing(balance_, pools_, target, shape);
    Eigen::VectorXd volumes = missing_;
    for (int pool = 0; pool < pools_.n(); ++pool) {
      if (shape.is_at_limit[static_cast<size_t>(pool)]) volumes[pool] = 0.0;
    }
    if (volumes.cwiseAbs().sum() <= round_off) return true;
    if (!response_.correct_volumes(balance_, shape, missing_, dx_, dp_)) break;
    shape.displacement += dx_;
    shape.pressure += dp_;
    bring_to(shape);
  }
  if (balance_.is_folded()) reason_ = "a hexahedron of the tissue is turned inside out";
  return reason_.empty();
}

}  // namespace lipofill::equilibrium
