#include "core/forecast/distribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "absl/strings/str_cat.h"

namespace lipofill::forecast {
namespace {

/// A default distribution ends so many spreads from its centre.
constexpr double kEnds = 3.0;
/// Less of a distribution between its ends than this is nothing.
constexpr double kLeastMass = 1e-6;

/// The normal variable behind a value of a normal or log-normal distribution.
double normal_of(const Distribution& d, double value) {
  if (d.law == Law::kNormal) return (value - d.centre) / d.spread;
  return value > 0.0 ? std::log(value / d.centre) / d.spread : -std::numeric_limits<double>::infinity();
}

std::string with_unit(double value, const std::string& unit) {
  return unit.empty() ? absl::StrCat(value) : absl::StrCat(value, " ", unit);
}

}  // namespace

double normal_share(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

/// Newton's iteration on the error function, on the side where it keeps its digits.
double normal_quantile(double share) {
  if (share > 0.5) return -normal_quantile(1.0 - share);
  double x = 0.0;
  for (int k = 0; k < 60; ++k) {
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    const double move = std::clamp((normal_share(x) - share) / density, -0.5, 0.5);
    x -= move;
    if (std::abs(move) < 1e-15) break;
  }
  return x;
}

Distribution Distribution::normal(double mean, double standard_deviation) {
  return {Law::kNormal, mean, standard_deviation, mean - kEnds * standard_deviation, mean + kEnds * standard_deviation};
}

Distribution Distribution::log_normal(double median, double spread_of_logarithm) {
  const double factor = std::exp(kEnds * spread_of_logarithm);
  return {Law::kLogNormal, median, spread_of_logarithm, median / factor, median * factor};
}

double Distribution::quantile(double share) const {
  if (law == Law::kUniform) return low + share * (high - low);
  if (law == Law::kTriangular) {
    const double rising = (centre - low) / (high - low);
    if (share <= rising) return low + std::sqrt(share * (high - low) * (centre - low));
    return high - std::sqrt((1.0 - share) * (high - low) * (high - centre));
  }
  const double first = normal_share(normal_of(*this, low));
  const double last = normal_share(normal_of(*this, high));
  const double x = normal_quantile(first + share * (last - first));
  const double value = law == Law::kNormal ? centre + spread * x : centre * std::exp(spread * x);
  return std::clamp(value, low, high);
}

void check_distribution(std::string_view field, const Distribution& d, double least, double most,
                        const std::string& unit, FieldViolations& violations) {
  const std::string prefix(field);
  const auto is_finite = [&](const char* name, double value) {
    if (std::isfinite(value)) return true;
    violations.add(absl::StrCat(prefix, ".", name), "must be given and finite");
    return false;
  };
  bool is_good = is_finite("low", d.low) && is_finite("high", d.high);
  if (d.law != Law::kUniform) is_good = is_finite("centre", d.centre) && is_good;
  if (d.is_gaussian() && !(std::isfinite(d.spread) && d.spread > 0.0)) {
    violations.add(prefix + ".spread", absl::StrCat("is ", d.spread, ", must be greater than 0"));
    is_good = false;
  }
  if (d.law == Law::kLogNormal && !(d.centre > 0.0)) {
    violations.add(prefix + ".centre", absl::StrCat("is ", d.centre, ", must be greater than 0"));
    is_good = false;
  }
  if (!is_good) return;
  if (d.low >= d.high) {
    violations.add(prefix + ".high", absl::StrCat("is ", d.high, ", must be greater than low, which is ", d.low));
    return;
  }
  if (d.law == Law::kTriangular && (d.centre < d.low || d.centre > d.high)) {
    violations.add(prefix + ".centre",
                   absl::StrCat("is ", d.centre, ", must lie between low and high, ", d.low, " and ", d.high));
  }
  if (d.is_gaussian() && normal_share(normal_of(d, d.high)) - normal_share(normal_of(d, d.low)) < kLeastMass) {
    violations.add(prefix + ".low", absl::StrCat("to ", d.high, " holds next to nothing of the distribution"));
  }
  if (d.low < least) {
    violations.add(prefix + ".low", absl::StrCat("is ", with_unit(d.low, unit), ": less than ", with_unit(least, unit),
                                                 " is not possible"));
  }
  if (d.high > most) {
    violations.add(prefix + ".high", absl::StrCat("is ", with_unit(d.high, unit), ": more than ", with_unit(most, unit),
                                                  " is not possible"));
  }
}

}  // namespace lipofill::forecast
