#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/simulation/simulation.h"

namespace lipofill::simulation {

/// The error says what the width of the hexahedra makes of a settled result: how far it is from
/// that of a grid without end. Estimates; signs are not known.
struct DiscretisationError {
  double lift = 0.0;      ///< of the largest displacement of the skin, as a share of it
  double pressure = 0.0;  ///< of a zone's mean pressure, as a share of it; the largest over the zones
  double skin = 0.0;      ///< of the skin's displacement; 95 of 100 nodes have less [m]
};

/// Solves the plan of a settled simulation on half as many divisions along both directions of the
/// chart (plan::halve_model) and extrapolates (Richardson):
///
///     error = |fine - coarse| / (r^p - 1),   r = ratio of the widths, p = 1.5
///
/// Lift and pressure converge with an order of 1.5 to 2, so the estimate errs to the large side.
/// Elements through the layers stay: what they make is not in it. FAILED_PRECONDITION with a
/// sentence that says why nothing can be said: the simulation has not settled, has no tissue, too
/// few divisions, or its coarse plan has not come to rest. Deterministic. Checked by
/// tests/verification/coupling/discretisation_test.cc against refined grids.
absl::StatusOr<DiscretisationError> estimate_discretisation_error(const Simulation& settled);

/// A share of this much, or more, is remarked upon.
inline constexpr double kLargeDiscretisationError = 0.05;

/// The remark on an error: empty where nothing needs saying.
std::string remark_on(const DiscretisationError& error);

}  // namespace lipofill::simulation
