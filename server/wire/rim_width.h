#pragma once

#include "core/base/field_violations.h"
#include "core/base/units.h"

namespace lipofill::server {

/// The width of the rim [m] that a request with `rim_mm` leaves out of comparisons, by default 5
/// mm; a violation where it is out of its bounds. Checked by
/// tests/unit/server/backend/evaluation_detail_test.cc.
template <typename Request>
double read_rim_width(const Request& request, FieldViolations& violations) {
  constexpr double kMostMm = 50.0, kDefaultMm = 5.0;
  const double rim_mm = request.has_rim_mm() ? request.rim_mm() : kDefaultMm;
  violations.check_range("rim_mm", rim_mm, 0.0, kMostMm, "mm");
  return rim_mm * kMetresPerMillimetre;
}

}  // namespace lipofill::server
