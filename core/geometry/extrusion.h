#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/face_geometry.h"
#include "core/geometry/layered_grid.h"

namespace lipofill::geometry {

/// Nodes of all levels: each node of the skin moved inwards, layer by layer, along the skin's
/// normals smoothed over the grid as far as the hexahedra need to stay well shaped where the face
/// curves. Thickness is measured along the skin's normal.
/// @param skin  (3, nodes_per_level), xi fastest; xi x eta points outwards [m]
/// FAILED_PRECONDITION, naming the place [mm] and the layer, where the worst scaled Jacobian stays
/// below 0.1.
/// @param folded  out, where not null: the places of the skin over hexahedra that stay below it [m]
absl::StatusOr<LayeredGrid> extrude_layers(const Eigen::Matrix3Xd& skin, int n_xi, int n_eta,
                                           const std::vector<LayerGeometry>& layers,
                                           std::vector<Eigen::Vector3d>* folded = nullptr);

}  // namespace lipofill::geometry
