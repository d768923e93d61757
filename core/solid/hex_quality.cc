#include "core/solid/hex_quality.h"

#include <algorithm>
#include <limits>

#include "core/base/lanes.h"

namespace lipofill::solid {
namespace {

using Point = Vector3<Lanes>;

/// Places in a hexahedron of its nodes in binary order: bit k for the side along local coordinate
/// k.
constexpr int kCorner[8] = {0, 1, 3, 2, 4, 5, 7, 6};

/// A vector of each lane and its squared length.
struct Edge {
  const Point& vector;
  const Lanes& square;
};

/// det[a b c]/(|a| |b| |c|), -1 where a vector has no length or is not finite.
LIPOFILL_INLINE Lanes scale_determinant(const Edge& a, const Edge& b, const Edge& c) {
  const Lanes product = a.square * b.square * c.square;
  const LaneMask is_valid = (product > 0.0) & (product < std::numeric_limits<double>::infinity());
  const Lanes scaled = dot(a.vector, cross(b.vector, c.vector)) / square_root(product);
  return is_valid ? scaled : fill_lanes(-1.0);
}

Lanes compute_scaled_jacobian(const Point (&x)[8]) {
  Point along[3][8];
  Lanes square[3][8];
  for (int k = 0; k < 3; ++k) {
    const int bit = 1 << k;
    for (int b = 0; b < 8; ++b) {
      if (b & bit) continue;
      along[k][b] = along[k][b | bit] = x[b | bit] - x[b];
      square[k][b] = square[k][b | bit] = dot(along[k][b], along[k][b]);
    }
  }
  Point axis[3];
  Lanes axis_square[3];
  for (int k = 0; k < 3; ++k) {
    const int other = 1 << (k + 1) % 3;
    const int third = 1 << (k + 2) % 3;
    axis[k] = along[k][0] + along[k][other] + along[k][third] + along[k][other | third];
    axis_square[k] = dot(axis[k], axis[k]);
  }
  Lanes least = scale_determinant({axis[0], axis_square[0]}, {axis[1], axis_square[1]}, {axis[2], axis_square[2]});
  for (int b = 0; b < 8; ++b) {
    const Lanes corner =
        scale_determinant({along[0][b], square[0][b]}, {along[1][b], square[1][b]}, {along[2][b], square[2][b]});
    least = corner < least ? corner : least;
  }
  return least;
}

}  // namespace

double compute_min_scaled_jacobian(const HexMesh& mesh, const Eigen::Matrix3Xd& x) {
  Lanes least = fill_lanes(1.0);
  for (int first = 0; first < mesh.n_hexahedra(); first += kLanes) {
    Point nodes[8];
    for (int b = 0; b < 8; ++b) {
      int places[kLanes];
      for (int lane = 0; lane < kLanes; ++lane) {
        places[lane] = mesh.hexahedra[std::min(first + lane, mesh.n_hexahedra() - 1)][kCorner[b]];
      }
      nodes[b] = gather_points(x.data(), places);
    }
    const Lanes scaled = compute_scaled_jacobian(nodes);
    least = scaled < least ? scaled : least;
  }
  return std::min({least[0], least[1], least[2], least[3]});
}

}  // namespace lipofill::solid
