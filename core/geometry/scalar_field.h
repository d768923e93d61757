#pragma once

#include <vector>

#include "absl/status/status.h"

namespace lipofill::geometry {

/// A scalar over the chart: n_xi x n_eta samples spaced evenly, both ends included, xi running
/// fastest, bilinear between them. One sample is a constant. The unit is that of whoever holds the
/// field; metres, pascals and so on inside core.
struct ScalarField {
  int n_xi = 1;
  int n_eta = 1;
  std::vector<double> values = {0.0};

  static ScalarField constant(double value) { return {1, 1, {value}}; }

  /// Value at a chart point; points outside [0, 1] take the value of the nearest edge.
  double at(double xi, double eta) const;
  double minimum() const;
  double maximum() const;
  /// Mean of the samples.
  double mean() const;

  /// Checks the field. INVALID_ARGUMENT with the field violation "" when the shape and the number
  /// of values disagree, either count is 0 or above 4096, or a value is not finite.
  absl::Status validate() const;
};

}  // namespace lipofill::geometry
