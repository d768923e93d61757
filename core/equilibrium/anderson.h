#pragma once

#include <Eigen/Core>

namespace lipofill::equilibrium {

/// Anderson's acceleration of a fixed-point iteration y <- y + f(y) (Walker & Ni 2011, type II):
///
///     y' = y + f - (dY + dF) c,   c = argmin |f - dF c|
///
/// with the last kDepth differences of y and f as columns of dY and dF. Sums in a fixed order.
/// Checked by tests/unit/equilibrium/anderson_test.cc.
class AndersonMixing {
 public:
  static constexpr int kDepth = 8;

  /// Forgets the past.
  void reset() {
    n_ = 0;
    has_last_ = false;
  }
  /// Goes on from another y, or towards another fixed point, with what is known of how f changes.
  void leap() { has_last_ = false; }

  /// Returns y', and learns from y and f.
  /// @param n_measured  the first entries of f, over which its size is minimised
  void mix(const Eigen::VectorXd& y, const Eigen::VectorXd& f, Eigen::Index n_measured, Eigen::VectorXd& next);

 private:
  void learn(const Eigen::VectorXd& dy, const Eigen::VectorXd& df, Eigen::Index n_measured);
  void apply(const Eigen::VectorXd& y, const Eigen::VectorXd& f, Eigen::Index n_measured, Eigen::VectorXd& next) const;

  int n_ = 0;  ///< differences since the last reset
  bool has_last_ = false;
  Eigen::VectorXd last_y_, last_f_;
  Eigen::MatrixXd moved_;    ///< dY, columns in turn
  Eigen::MatrixXd changed_;  ///< dF
  Eigen::MatrixXd gram_;     ///< dF^T dF over what is measured
};

}  // namespace lipofill::equilibrium
