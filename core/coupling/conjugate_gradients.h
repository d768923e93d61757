#pragma once

#include <Eigen/Core>

#include "core/coupling/pressure_system.h"

namespace lipofill::coupling {

/// Preconditioned conjugate gradients from dp = 0 in the cells that are not held,
///
///     z = M^-1 r,   d <- z + beta d,   w = C d,   q = w + dt J d,   alpha = (r . z) / (d . q)
///     dp += alpha d,   moved += alpha w,   r -= alpha q,   beta = (r . z) / (r . z of the last iteration)
///
/// which give what the walls move, C dp, at no further cost.
class ConjugateGradients {
 public:
  /// An iteration as `move` sees it, which may make the new w from the last one.
  struct Iterate {
    const Eigen::VectorXd& residual;     ///< r
    const Eigen::VectorXd& conditioned;  ///< z
    const Eigen::VectorXd& direction;    ///< d
    double share_of_last;                ///< beta; 0 in the first iteration
  };

  /// @param precondition  (r, z): z = M^-1 r
  /// @param move          (iterate, w): w = C d
  /// @param tolerance     largest residual that may be left
  /// Returns false when there is no descent or it takes more than `most` iterations.
  template <typename Precondition, typename Move>
  bool solve(const PressureSystem& system, const Eigen::VectorXd& r, double tolerance, int most,
             Precondition precondition, Move move, Eigen::VectorXd& dp, Eigen::VectorXd& moved);

  /// Counts of solves and of their iterations since the start.
  long n_solves() const { return n_solves_; }
  long n_iterations() const { return n_iterations_; }

 private:
  Eigen::VectorXd residual_, direction_, conditioned_, product_, moved_direction_;
  long n_solves_ = 0;
  long n_iterations_ = 0;
};

template <typename Precondition, typename Move>
bool ConjugateGradients::solve(const PressureSystem& system, const Eigen::VectorXd& r, double tolerance, int most,
                               Precondition precondition, Move move, Eigen::VectorXd& dp, Eigen::VectorXd& moved) {
  ++n_solves_;
  dp.setZero(system.n_cells());
  moved.setZero(system.n_cells());
  residual_ = r;
  double last_descent = 0.0;
  for (int k = 0; k <= most; ++k) {
    if (residual_.cwiseAbs().maxCoeff() <= tolerance) return true;
    if (k == most) break;
    precondition(residual_, conditioned_);
    system.hold(conditioned_);
    const double descent = residual_.dot(conditioned_);
    if (!(descent > 0.0)) return false;
    const double share_of_last = k == 0 ? 0.0 : descent / last_descent;
    if (k == 0) {
      direction_ = conditioned_;
    } else {
      direction_ = conditioned_ + share_of_last * direction_;
    }
    move(Iterate{residual_, conditioned_, direction_, share_of_last}, moved_direction_);
    product_ = moved_direction_;
    system.add_mobility(direction_, product_);
    system.hold(product_);
    const double curvature = direction_.dot(product_);
    if (!(curvature > 0.0)) return false;
    const double share = descent / curvature;
    dp += share * direction_;
    moved += share * moved_direction_;
    residual_ -= share * product_;
    last_descent = descent;
    ++n_iterations_;
  }
  return false;
}

}  // namespace lipofill::coupling
