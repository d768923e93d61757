#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lipofill::planning {

/// Standard deviation of residuals of which less than half are outliers: 1.4826 times the median of
/// their sizes, at least 0.05 mm [m]. There must be a residual.
inline double estimate_deviation(std::vector<double> residuals) {
  constexpr double kDeviationsPerMedian = 1.4826;  // of a normal distribution
  constexpr double kLeastDeviation = 5e-5;         // [m]
  for (double& residual : residuals) residual = std::abs(residual);
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return std::max(kLeastDeviation, kDeviationsPerMedian * *middle);
}

/// Tukey's biweight: 0 beyond 4.685 deviations, 95 % efficient on a normal distribution.
inline double weigh_residual(double residual, double deviation) {
  constexpr double kTukey = 4.685;
  const double u = residual / (kTukey * deviation);
  return std::abs(u) < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
}

}  // namespace lipofill::planning
