#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/forecast/retention.h"

namespace lipofill::forecast {

/// The forecast of a zone says what to inject into a zone so that a volume is left, and what is
/// left of what is planned. [m3]
struct ZoneForecast {
  std::string zone;
  double planned = 0.0;
  double remaining = 0.0, remaining_p05 = 0.0, remaining_p95 = 0.0;
  double wanted = 0.0;
  double inject = 0.0, inject_low = 0.0, inject_high = 0.0;
  double most_at_once = 0.0;  ///< infinity where no pressure that was tried reaches the band
};

/// A session says what goes into each zone at a time. [m3]
struct Session {
  double month = 0.0;
  Eigen::VectorXd inject;
  Eigen::VectorXd present;  ///< just before, as expected
};

/// Volume to inject so that `wanted` is left after a month in so large a part of all patients:
/// wanted / R. [m3]
double volume_to_inject(const Retention& retention, double month, double wanted, double part);

/// The largest multiple of the planned volumes under which each zone's pressure stays below its
/// bound, between multiples that were tried by a line; infinity where all that were tried stay
/// below.
/// @param multiples  ascending, above 0
/// @param pressures  [Pa] (zones, multiples)
/// @param bounds     [Pa] (zones)
Eigen::VectorXd largest_multiples(const Eigen::VectorXd& multiples, const Eigen::MatrixXd& pressures,
                                  const Eigen::VectorXd& bounds);

/// The fewest sessions, at equal distances in time, after which what is wanted is left in every
/// zone so many months after the last of them, and no zone ever holds more than it may at once:
/// each session fills up to that, or as much as is still needed. Kept shares are those of the
/// median patient. Empty where eight sessions do not reach it.
/// Checked by tests/unit/forecast/sessions_test.cc.
/// @param between  months between sessions
/// @param last     months from the last session to when the wanted volume is to be there
std::vector<Session> plan_sessions(const Retention& retention, const std::vector<ZoneForecast>& zones, double between,
                                   double last);

}  // namespace lipofill::forecast
