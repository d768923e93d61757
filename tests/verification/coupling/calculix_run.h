#pragma once

#include <Eigen/Core>

#include <string>

#include "absl/status/statusor.h"

namespace lipofill::verification {

/// Whether `ccx`, the solver of CalculiX, can be called.
bool has_calculix();

/// What CalculiX makes of a deck.
struct CalculixResult {
  Eigen::Matrix3Xd skin;  ///< displacement of the skin's nodes under the whole load [m], in their order
  double seconds = 0.0;   ///< it took so long on one core
};

/// Has ccx solve the deck in a folder of its own. INTERNAL, with the end of what it said, when it
/// does not get to the whole load.
absl::StatusOr<CalculixResult> solve_with_calculix(const std::string& deck);

/// The deck with compressible neo-Hookean tissue of the same moduli at small strain in place of
/// linear elasticity between second Piola-Kirchhoff stress and Green-Lagrange strain, which is what
/// ccx makes of *ELASTIC with NLGEOM.
std::string with_neo_hookean_tissue(const std::string& deck);

}  // namespace lipofill::verification
