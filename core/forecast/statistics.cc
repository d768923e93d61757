#include "core/forecast/statistics.h"

#include <algorithm>
#include <cmath>

namespace lipofill::forecast {
namespace {

template <typename Vector, typename Number>
Number find_quantile(Vector& values, Number share) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<Number>(values.size());
  const Number place = std::clamp(share * n - Number(0.5), Number(0), n - Number(1));
  const auto below = static_cast<Eigen::Index>(place);
  const Eigen::Index above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<Number>(below)) * (values[above] - values[below]);
}

}  // namespace

double quantile_of(Eigen::VectorXd& values, double share) {
  return find_quantile(values, share);
}

float quantile_of(Eigen::VectorXf& values, float share) {
  return find_quantile(values, share);
}

Spread summarise(const Eigen::VectorXd& values) {
  Spread spread;
  spread.mean = values.mean();
  spread.standard_deviation =
      std::sqrt((values.array() - spread.mean).square().sum() / static_cast<double>(values.size() - 1));
  Eigen::VectorXd sorted = values;
  spread.p05 = quantile_of(sorted, 0.05);
  spread.p50 = quantile_of(sorted, 0.50);
  spread.p95 = quantile_of(sorted, 0.95);
  return spread;
}

}  // namespace lipofill::forecast
