#pragma once

#include <string>
#include <vector>

#include "core/forecast/forecast.h"
#include "tests/verification/forecast/direct_twins.h"

namespace lipofill::verification {

/// A forecast of the twins' plan on the model as it is, at once and after twelve months.
absl::StatusOr<forecast::Forecast> make_twin_forecast(const TwinCase& twin_case, int members);

/// The figure of a time that Twin::figure(k) is.
const forecast::ForecastFigure& figure_of(const forecast::ForecastTime& time, int k);
std::string figure_name(int k);

/// The shares of twins whose figures the intervals of 90 of 100 hold; of a vertex, the mean over
/// those that move.
struct Shares {
  double lift = 0.0, volume = 0.0, pressure = 0.0, node = 0.0;
};
Shares find_shares(const forecast::ForecastTime& time, const std::vector<Twin>& twins);

/// How far the indices of a figure's polynomials are from those of runs, at most over the inputs,
/// and the largest standard error of the latter.
struct IndexGap {
  double first = 0.0, total = 0.0, error = 0.0;
};
IndexGap find_gap(const forecast::ForecastFigure& figure, int k, const PickedIndices& picked);

}  // namespace lipofill::verification
