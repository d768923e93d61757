#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cpp/scene/tissue_deck_reader.h"

namespace lipofill::client {

/// Strain and stress of a hexahedron at its centre.
///
///     F = sum_a x_a (grad N_a)(X),   J = det F,   E = (F^T F - 1) / 2
///
/// Corotational layers: F = R U, sigma = R (2 mu e + (kappa - 2/3 mu) tr(e) 1) R^T with e = U - 1.
/// Neo-Hookean: sigma = mu J^-5/3 dev(F F^T) + kappa (J - 1) 1. What the elements' enhanced modes
/// and a prestress add is not in them.
struct CellFields {
  double volume_ratio = 1.0;          ///< J
  double largest_strain = 0.0;        ///< largest eigenvalue of E
  double equivalent_strain = 0.0;     ///< sqrt(2/3 dev(E) : dev(E))
  double von_mises_stress_kpa = 0.0;  ///< sqrt(3/2 dev(sigma) : dev(sigma))
  double mean_stress_kpa = 0.0;       ///< tr(sigma) / 3, tension positive
};

/// Computes them. Checked by tests/unit/client/tissue_fields_test.cc.
/// @param rest, moved  the corners [mm] (3, 8), in the order of VTK_HEXAHEDRON
CellFields compute_cell_fields(const Eigen::Matrix<double, 3, 8>& rest, const Eigen::Matrix<double, 3, 8>& moved,
                               const DeckLayer& layer);

/// Writes the last state of the tissue of a folder of results with "layer" (from 1, the skin), and
/// what CellFields has, on its cells; the names of the layers are the field "layer_names".
/// INVALID_ARGUMENT for a folder without tissue, or a deck of another model. Checked by
/// tests/python/test_scenes.py.
absl::Status write_tissue_fields(const std::filesystem::path& folder, const std::filesystem::path& deck,
                                 const std::filesystem::path& out);

}  // namespace lipofill::client
