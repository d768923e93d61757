#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "core/solid/hex_mesh.h"
#include "core/solid/material.h"

namespace lipofill::solid::testing {

using PointMap = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

/// A box of hexahedra, node (i, j, k) at (k (n_y + 1) + j) (n_x + 1) + i, k along zeta.
struct Box {
  std::array<int, 3> n = {1, 1, 1};
  Eigen::Vector3d size = Eigen::Vector3d::Ones();
  bool stacked = false;
  PointMap map = nullptr;  ///< moves the nodes of the regular box

  int node(int i, int j, int k) const { return (k * (n[1] + 1) + j) * (n[0] + 1) + i; }
  int n_nodes() const { return (n[0] + 1) * (n[1] + 1) * (n[2] + 1); }
  HexMesh make() const;
};

/// Calls `visit(node, i, j, k)` for every node.
template <class Visit>
void for_each_node(const Box& box, const Visit& visit) {
  for (int k = 0; k <= box.n[2]; ++k) {
    for (int j = 0; j <= box.n[1]; ++j) {
      for (int i = 0; i <= box.n[0]; ++i) visit(box.node(i, j, k), i, j, k);
    }
  }
}

inline HexMesh Box::make() const {
  HexMesh mesh;
  mesh.rest_positions.resize(3, n_nodes());
  for_each_node(*this, [&](int a, int i, int j, int k) {
    const Eigen::Vector3d p(size[0] * i / n[0], size[1] * j / n[1], size[2] * k / n[2]);
    mesh.rest_positions.col(a) = map ? map(p) : p;
  });
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        mesh.hexahedra.push_back({node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k),
                                  node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1),
                                  node(i, j + 1, k + 1)});
      }
    }
  }
  mesh.material.assign(mesh.hexahedra.size(), 0);
  mesh.stacked.assign(mesh.hexahedra.size(), stacked);
  return mesh;
}

/// Random displacement of the nodes, up to `amplitude` times the node spacing in each of the
/// components asked for. The same on every machine.
class Jitter {
 public:
  explicit Jitter(unsigned seed) : state_(seed) {}
  double next() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) / 4503599627370496.0 - 1.0;  // 53 bits on [-1, 1)
  }
  Eigen::Vector3d next_vector() {
    const double x = next();
    const double y = next();
    return {x, y, next()};
  }

 private:
  unsigned long long state_;
};

/// Moves the nodes inside the box in the plane, the same at every level.
inline void distort_in_plane(const Box& box, double amplitude, unsigned seed, HexMesh& mesh) {
  Jitter jitter(seed);
  const Eigen::Vector2d spacing(box.size[0] / box.n[0], box.size[1] / box.n[1]);
  for (int j = 1; j < box.n[1]; ++j) {
    for (int i = 1; i < box.n[0]; ++i) {
      const Eigen::Vector2d shift = amplitude * jitter.next_vector().head<2>().cwiseProduct(spacing);
      for (int k = 0; k <= box.n[2]; ++k) mesh.rest_positions.col(box.node(i, j, k)).head<2>() += shift;
    }
  }
}

/// Moves all nodes strictly inside the box in space.
inline void distort_inside(const Box& box, double amplitude, unsigned seed, HexMesh& mesh) {
  Jitter jitter(seed);
  for_each_node(box, [&](int a, int i, int j, int k) {
    const Eigen::Vector3d shift = amplitude * jitter.next_vector();
    const bool inside = i > 0 && j > 0 && k > 0 && i < box.n[0] && j < box.n[1] && k < box.n[2];
    if (!inside) return;
    for (int c = 0; c < 3; ++c) mesh.rest_positions(c, a) += shift[c] * box.size[c] / box.n[c];
  });
}

}  // namespace lipofill::solid::testing
