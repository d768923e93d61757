#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace lipofill::solid {

/// Hexahedra in their rest shape. Nodes 0-3 of a hexahedron are its deep face, 4-7 the face towards
/// the skin, each anticlockwise seen from the skin: local coordinates (xi, eta, zeta) of node a are
///     (-,-,-) (+,-,-) (+,+,-) (-,+,-) (-,-,+) (+,-,+) (+,+,+) (-,+,+).
/// zeta is the direction through the thickness, which the solid-shell element treats differently.
struct HexMesh {
  Eigen::Matrix3Xd rest_positions;            ///< [m]  (3, n_nodes)
  std::vector<std::array<int, 8>> hexahedra;  ///< node indices
  std::vector<int> material;                  ///< a material index a hexahedron
  /// True for a hexahedron that is one of several through its layer: it takes the EAS-9 element,
  /// all others the solid-shell.
  std::vector<bool> stacked;

  int n_nodes() const { return static_cast<int>(rest_positions.cols()); }
  int n_hexahedra() const { return static_cast<int>(hexahedra.size()); }

  /// Positions of a hexahedron's nodes out of those of all, x (3, n_nodes).
  Eigen::Matrix<double, 3, 8> gather(int hexahedron, const Eigen::Matrix3Xd& x) const {
    Eigen::Matrix<double, 3, 8> nodes;
    for (int a = 0; a < 8; ++a) nodes.col(a) = x.col(hexahedra[hexahedron][a]);
    return nodes;
  }
};

}  // namespace lipofill::solid
