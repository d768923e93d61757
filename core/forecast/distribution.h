#pragma once

#include <limits>
#include <string>
#include <string_view>

#include "core/base/field_violations.h"

namespace lipofill::forecast {

enum class Law { kNormal, kLogNormal, kUniform, kTriangular };

/// A distribution of a number, cut off at both ends:
///
///     kNormal      centre: mean,    spread: standard deviation
///     kLogNormal   centre: median,  spread: standard deviation of the logarithm
///     kUniform     between the ends
///     kTriangular  between the ends, centre: the most likely value
///
/// Checked by tests/unit/forecast/distribution_test.cc.
struct Distribution {
  Law law = Law::kNormal;
  double centre = 1.0;
  double spread = 0.0;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  /// Three spreads to both sides of the centre, beyond which nobody has looked.
  static Distribution normal(double mean, double standard_deviation);
  static Distribution log_normal(double median, double spread_of_logarithm);

  /// True for laws whose own variable, in which polynomials are taken, is normal; the others' is
  /// uniform on [-1, 1].
  bool is_gaussian() const { return law == Law::kNormal || law == Law::kLogNormal; }
  /// The value that a share of all lie below.
  /// @param share  in (0, 1)
  double quantile(double share) const;
  double median() const { return quantile(0.5); }
};

/// The value below which a standard normal variable lies with a probability in (0, 1).
double normal_quantile(double share);
/// The probability that a standard normal variable lies below x.
double normal_share(double x);

/// Adds what is wrong with a distribution: numbers that are not finite, no spread, ends in the
/// wrong order or that hold nothing of it, a part below `least` or above `most`, which are the
/// bounds of what is possible.
/// @param unit  of its values, for messages; "" for multiples
void check_distribution(std::string_view field, const Distribution& distribution, double least, double most,
                        const std::string& unit, FieldViolations& violations);

}  // namespace lipofill::forecast
