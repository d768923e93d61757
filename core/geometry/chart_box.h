#pragma once

namespace lipofill::geometry {

/// A rectangle of the chart.
struct ChartBox {
  double xi_min = 0.0;
  double xi_max = 1.0;
  double eta_min = 0.0;
  double eta_max = 1.0;
};

}  // namespace lipofill::geometry
