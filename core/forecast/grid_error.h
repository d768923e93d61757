#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::forecast {

/// The error tells how far the nominal shape at once is from that of a grid without end.
struct GridError {
  double lift = 0.0;      ///< of the largest displacement of the skin, as a share of it
  double pressure = 0.0;  ///< of a zone's mean pressure, as a share of it; the largest over the zones
  double skin = 0.0;      ///< of the skin's displacement; 95 of 100 nodes have less [m]
  /// Observed over three grids; none where a third is too coarse, or two do not differ.
  std::optional<double> lift_order;
  std::optional<double> pressure_order;
  /// Both orders are what the extrapolation takes them for, or what they extrapolate is next to
  /// nothing. Where not, the errors are the plain differences of the two finest grids.
  bool order_holds = false;
};

/// Solves the plan on its grid, on one half as fine, and on one half as fine as that:
///
///     error = |e1| / (r^1.5 - 1),   e1 = fine - coarse, e2 = coarse - coarser
///     order = log(e2/e1) / log(r)   r = ratio of the widths
///
/// The order holds in [1, 4], or where |e1| is below 0.002 of the figure. FAILED_PRECONDITION with
/// a sentence that says why nothing can be said. Deterministic. Checked by
/// tests/unit/forecast/grid_error_test.cc and tests/verification/coupling/discretisation_test.cc.
absl::StatusOr<GridError> estimate_grid_error(const std::shared_ptr<const model::FaceModel>& model,
                                              const plan::SimulationSpec& plan);

/// The remark on an error whose order does not hold; empty where it does.
std::string remark_on_order(const GridError& error);

}  // namespace lipofill::forecast
