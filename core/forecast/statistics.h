#pragma once

#include <Eigen/Core>

namespace lipofill::forecast {

/// A figure over the members.
struct Spread {
  double mean = 0.0;
  double standard_deviation = 0.0;
  double p05 = 0.0;
  double p50 = 0.0;
  double p95 = 0.0;
};

/// @pre  there are two values at least
/// Checked by tests/unit/forecast/statistics_test.cc.
Spread summarise(const Eigen::VectorXd& values);

/// The value that a share of all lie below: between the middles of equal parts that the sorted
/// values stand for, as a line (Hazen 1914). Sorts the values.
double quantile_of(Eigen::VectorXd& values, double share);
float quantile_of(Eigen::VectorXf& values, float share);

}  // namespace lipofill::forecast
