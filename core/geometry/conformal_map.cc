#include "core/geometry/conformal_map.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

using Complex = std::complex<double>;

/// The edges opposite the corners, in a frame of the triangle's own plane.
std::array<Complex, 3> compute_opposite_edges(const SurfaceMesh& mesh, const std::array<int, 3>& triangle) {
  const Eigen::Vector3d e1 = mesh.points.col(triangle[1]) - mesh.points.col(triangle[0]);
  const Eigen::Vector3d e2 = mesh.points.col(triangle[2]) - mesh.points.col(triangle[0]);
  const Eigen::Vector3d x = e1.normalized();
  const Eigen::Vector3d y = e1.cross(e2).normalized().cross(x);
  const Complex p1(e1.norm(), 0.0);
  const Complex p2(e2.dot(x), e2.dot(y));
  return {p2 - p1, -p2, p1};
}

/// Vertices numbered without the two pins; -1 at a pin.
std::vector<int> number_free_vertices(int n_vertices, int pin_a, int pin_b) {
  std::vector<int> number(n_vertices, -1);
  int next = 0;
  for (int v = 0; v < n_vertices; ++v) {
    if (v != pin_a && v != pin_b) number[v] = next++;
  }
  return number;
}

}  // namespace

absl::StatusOr<Eigen::Matrix2Xd> compute_conformal_map(const SurfaceMesh& mesh, int pin_a, int pin_b) {
  const int n = mesh.n_vertices();
  const std::vector<int> number = number_free_vertices(n, pin_a, pin_b);
  std::vector<Complex> at_pin(n, Complex(0.0, 0.0));
  at_pin[pin_b] = (mesh.points.col(pin_b) - mesh.points.col(pin_a)).norm();
  std::vector<Eigen::Triplet<Complex>> entries;
  entries.reserve(mesh.triangles.size() * 6);
  Eigen::VectorXcd right = Eigen::VectorXcd::Zero(n - 2);
  for (const auto& triangle : mesh.triangles) {
    const double twice_area = compute_area_vector(mesh, triangle).norm();
    const std::array<Complex, 3> w = compute_opposite_edges(mesh, triangle);
    for (int j = 0; j < 3; ++j) {
      const int row = number[triangle[j]];
      if (row < 0) continue;
      for (int k = 0; k < 3; ++k) {
        const Complex entry = std::conj(w[j]) * w[k] / twice_area;
        const int column = number[triangle[k]];
        if (column < 0) {
          right[row] -= entry * at_pin[triangle[k]];
        } else if (row >= column) {
          entries.emplace_back(row, column, entry);
        }
      }
    }
  }
  Eigen::SparseMatrix<Complex> matrix(n - 2, n - 2);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<Complex>> factor(matrix);
  if (factor.info() != Eigen::Success) return absl::FailedPreconditionError("the patch of skin cannot be flattened");
  const Eigen::VectorXcd solution = factor.solve(right);
  if (!solution.allFinite()) return absl::FailedPreconditionError("the patch of skin cannot be flattened");
  Eigen::Matrix2Xd flat(2, n);
  for (int v = 0; v < n; ++v) {
    const Complex u = number[v] < 0 ? at_pin[v] : solution[number[v]];
    flat.col(v) = Eigen::Vector2d(u.real(), u.imag());
  }
  return flat;
}

namespace {

/// A vertex in the middle of every border but the longest, and the longest border itself.
struct ClosedDisc {
  SurfaceMesh mesh;
  std::vector<int> rim;
};

double compute_length(const SurfaceMesh& mesh, const std::vector<int>& loop) {
  double length = 0.0;
  for (size_t k = 0; k < loop.size(); ++k) {
    length += (mesh.points.col(loop[(k + 1) % loop.size()]) - mesh.points.col(loop[k])).norm();
  }
  return length;
}

ClosedDisc close_holes(const SurfaceMesh& mesh) {
  ClosedDisc disc{mesh, {}};
  auto loops = trace_boundary_loops(mesh, find_neighbours(mesh).across);
  std::stable_sort(loops.begin(), loops.end(),
                   [&](const auto& a, const auto& b) { return compute_length(mesh, a) > compute_length(mesh, b); });
  if (loops.empty()) return disc;
  disc.rim = loops.front();
  for (size_t k = 1; k < loops.size(); ++k) {
    const int centre = disc.mesh.n_vertices();
    disc.mesh.points.conservativeResize(3, centre + 1);
    disc.mesh.points.col(centre).setZero();
    for (const int v : loops[k])
      disc.mesh.points.col(centre) += mesh.points.col(v) / static_cast<double>(loops[k].size());
    for (size_t m = 0; m < loops[k].size(); ++m) {
      disc.mesh.triangles.push_back({loops[k][(m + 1) % loops[k].size()], loops[k][m], centre});
    }
  }
  return disc;
}

/// Places the rim on the unit circle by arc length; the other vertices get no place.
std::vector<bool> place_rim(const ClosedDisc& disc, Eigen::Matrix2Xd& flat) {
  std::vector<bool> placed(disc.mesh.n_vertices(), false);
  const double whole = compute_length(disc.mesh, disc.rim);
  double along = 0.0;
  for (size_t k = 0; k < disc.rim.size(); ++k) {
    const double turn = 2.0 * std::numbers::pi * along / whole;
    flat.col(disc.rim[k]) = Eigen::Vector2d(std::cos(turn), std::sin(turn));
    placed[disc.rim[k]] = true;
    along += (disc.mesh.points.col(disc.rim[(k + 1) % disc.rim.size()]) - disc.mesh.points.col(disc.rim[k])).norm();
  }
  return placed;
}

/// tan(angle / 2) at corner k of a triangle, bounded for triangles that are nearly flat.
double half_angle_tangent(const SurfaceMesh& mesh, const std::array<int, 3>& triangle, int k) {
  const Eigen::Vector3d corner = mesh.points.col(triangle[k]);
  const Eigen::Vector3d a = mesh.points.col(triangle[(k + 1) % 3]) - corner;
  const Eigen::Vector3d b = mesh.points.col(triangle[(k + 2) % 3]) - corner;
  const double sine = a.cross(b).norm();
  const double cosine = a.dot(b);
  return std::min(sine / (std::hypot(sine, cosine) + cosine + 1e-30), 1e3);
}

}  // namespace

absl::StatusOr<Eigen::Matrix2Xd> compute_harmonic_map(const SurfaceMesh& mesh) {
  const ClosedDisc disc = close_holes(mesh);
  const int n = disc.mesh.n_vertices();
  Eigen::Matrix2Xd flat = Eigen::Matrix2Xd::Zero(2, n);
  const std::vector<bool> placed = place_rim(disc, flat);
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& triangle : disc.mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int v = triangle[k];
      if (placed[v]) continue;
      const double tangent = half_angle_tangent(disc.mesh, triangle, k);
      for (const int w : {triangle[(k + 1) % 3], triangle[(k + 2) % 3]}) {
        const double weight = tangent / std::max((disc.mesh.points.col(w) - disc.mesh.points.col(v)).norm(), 1e-9);
        entries.emplace_back(v, v, weight);
        entries.emplace_back(v, w, -weight);
      }
    }
  }
  for (int v = 0; v < n; ++v) {
    if (placed[v]) entries.emplace_back(v, v, 1.0);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> factor;
  factor.compute(matrix);
  if (factor.info() != Eigen::Success) return absl::FailedPreconditionError("the patch of skin cannot be flattened");
  const Eigen::MatrixX2d solution = factor.solve(Eigen::MatrixX2d(flat.transpose()));
  if (!solution.allFinite()) return absl::FailedPreconditionError("the patch of skin cannot be flattened");
  return Eigen::Matrix2Xd(solution.topRows(mesh.n_vertices()).transpose());
}

}  // namespace lipofill::geometry
