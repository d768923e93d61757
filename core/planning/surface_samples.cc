#include "core/planning/surface_samples.h"

#include <cmath>

#include "core/geometry/surface_topology.h"

namespace lipofill::planning {
namespace {

/// The fractional parts of k / g and k / g^2, g^3 = g + 1, fill the square evenly for any number of
/// points (M. Roberts, 2018).
constexpr double kFirstStep = 0.7548776662466927;
constexpr double kSecondStep = 0.5698402909980532;

/// A point of the unit square brought to barycentric coordinates that fill a triangle evenly.
Eigen::Vector3d spread_in_triangle(int k) {
  double u = std::fmod(0.5 + kFirstStep * k, 1.0);
  double v = std::fmod(0.5 + kSecondStep * k, 1.0);
  if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
  return {1.0 - u - v, u, v};
}

}  // namespace

SurfaceSamples sample_surface(const SkinSurface& skin, int n) {
  SurfaceSamples samples;
  samples.points.resize(3, n);
  samples.normals.resize(3, n);
  samples.spacing = std::sqrt(skin.area / n);
  double before = 0.0;
  int k = 0;
  for (int t = 0; t < skin.mesh.n_triangles() && k < n; ++t) {
    const auto& corner = skin.mesh.triangles[t];
    const double area = 0.5 * geometry::compute_area_vector(skin.mesh, corner).norm();
    const bool is_last = t + 1 == skin.mesh.n_triangles();
    for (; k < n && (is_last || (k + 0.5) * skin.area < n * (before + area)); ++k) {
      const Eigen::Vector3d b = spread_in_triangle(k);
      samples.points.col(k) = b[0] * skin.mesh.points.col(corner[0]) + b[1] * skin.mesh.points.col(corner[1]) +
                              b[2] * skin.mesh.points.col(corner[2]);
      samples.normals.col(k) =
          (b[0] * skin.normals.col(corner[0]) + b[1] * skin.normals.col(corner[1]) + b[2] * skin.normals.col(corner[2]))
              .normalized();
    }
    before += area;
  }
  return samples;
}

void smooth_normals(SurfaceSamples& samples, const SurfaceSamples& fine, double radius) {
  for (Eigen::Index k = 0; k < samples.size(); ++k) {
    Eigen::Vector3d sum = samples.normals.col(k);
    for (Eigen::Index j = 0; j < fine.size(); ++j) {
      const bool near = (fine.points.col(j) - samples.points.col(k)).squaredNorm() < radius * radius;
      // The other side of an ear or a lip is near, too.
      if (near && fine.normals.col(j).dot(samples.normals.col(k)) > 0.0) sum += fine.normals.col(j);
    }
    samples.normals.col(k) = sum.normalized();
  }
}

}  // namespace lipofill::planning
