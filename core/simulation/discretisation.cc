#include "core/simulation/discretisation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/base/units.h"
#include "core/simulation/half_grid.h"
#include "core/simulation/skin_difference.h"

namespace lipofill::simulation {
namespace {

constexpr double kOrder = 1.5;
constexpr double kToldShareOfSkin = 0.95;

/// Finds the value that `share` of the values do not exceed; 0 without any.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// |a - b| as a share of a; 0 where a is 0.
double relative_difference(double a, double b) {
  return a == 0.0 ? 0.0 : std::abs((a - b) / a);
}

double largest_pressure_difference(const Simulation& fine, const Simulation& coarse) {
  const std::vector<ZoneReport> of_fine = fine.zone_reports();
  const std::vector<ZoneReport> of_coarse = coarse.zone_reports();
  double largest = 0.0;
  for (size_t z = 0; z < std::min(of_fine.size(), of_coarse.size()); ++z) {
    largest = std::max(largest, relative_difference(of_fine[z].mean_pressure, of_coarse[z].mean_pressure));
  }
  return largest;
}

}  // namespace

absl::StatusOr<DiscretisationError> estimate_discretisation_error(const Simulation& settled) {
  const auto coarse = settle_on_half_grid(settled);
  if (!coarse.ok()) return coarse.status();
  const double ratio = ratio_of_widths(settled, **coarse);
  const double extrapolated = 1.0 / (std::pow(ratio, kOrder) - 1.0);
  DiscretisationError error;
  error.lift = extrapolated *
               relative_difference(settled.report().skin_max_displacement, (*coarse)->report().skin_max_displacement);
  error.pressure = extrapolated * largest_pressure_difference(settled, **coarse);
  const std::vector<double> squares =
      squared_skin_distances(settled.frame({"skin"}), (*coarse)->frame_on(settled.model().geometry));
  error.skin = extrapolated * std::sqrt(quantile(squares, kToldShareOfSkin)) * kMetresPerMillimetre;
  return error;
}

std::string remark_on(const DiscretisationError& error) {
  if (std::max(error.lift, error.pressure) < kLargeDiscretisationError) return "";
  return absl::StrFormat(
      "The grid is coarse for this plan: the lift is off by an estimated %.0f %%, a zone's pressure by %.0f %%, the "
      "skin "
      "by %.2f mm at 95 of 100 places; raise n_xi and n_eta of the model.",
      100.0 * error.lift, 100.0 * error.pressure, error.skin * kMillimetresPerMetre);
}

}  // namespace lipofill::simulation
