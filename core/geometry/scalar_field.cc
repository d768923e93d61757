#include "core/geometry/scalar_field.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"

namespace lipofill::geometry {
namespace {

constexpr int kMaxSamplesAlong = 4096;

/// The interval of a row of n samples that holds t, and where in it.
struct Interval {
  int first = 0;
  int second = 0;
  double fraction = 0.0;
};

Interval find_interval(double t, int n) {
  if (n == 1) return {};
  const double s = (t > 0.0 ? std::min(t, 1.0) : 0.0) * (n - 1);  // 0 for what is not a number
  const int first = std::min(static_cast<int>(s), n - 2);
  return {first, first + 1, s - first};
}

}  // namespace

double ScalarField::at(double xi, double eta) const {
  const Interval a = find_interval(xi, n_xi);
  const Interval b = find_interval(eta, n_eta);
  const auto row = [&](int j) {
    const size_t offset = static_cast<size_t>(j) * static_cast<size_t>(n_xi);
    return (1.0 - a.fraction) * values[offset + a.first] + a.fraction * values[offset + a.second];
  };
  return (1.0 - b.fraction) * row(b.first) + b.fraction * row(b.second);
}

double ScalarField::minimum() const {
  return *std::min_element(values.begin(), values.end());
}

double ScalarField::maximum() const {
  return *std::max_element(values.begin(), values.end());
}

double ScalarField::mean() const {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

absl::Status ScalarField::validate() const {
  FieldViolations violations;
  for (const int n : {n_xi, n_eta}) {
    if (n < 1 || n > kMaxSamplesAlong) {
      violations.add("", absl::StrCat("has ", n, " samples along one side, must have 1 to ", kMaxSamplesAlong));
    }
  }
  if (!violations.empty()) return violations.to_status();
  const size_t expected = static_cast<size_t>(n_xi) * static_cast<size_t>(n_eta);
  if (values.size() != expected) {
    return field_violation("", absl::StrCat("has ", values.size(), " values, must have ", n_xi, " x ", n_eta));
  }
  for (size_t k = 0; k < values.size(); ++k) {
    if (!std::isfinite(values[k])) return field_violation("", absl::StrCat("value ", k, " is not a finite number"));
  }
  return absl::OkStatus();
}

}  // namespace lipofill::geometry
