#pragma once

#include <Eigen/Core>

#include "core/planning/skin_surface.h"

namespace lipofill::planning {

/// Points spread evenly over a surface, with its normals there.
struct SurfaceSamples {
  Eigen::Matrix3Xd points;   ///< [m]  (3, n)
  Eigen::Matrix3Xd normals;  ///< unit
  double spacing = 0.0;      ///< root of the area that falls to each [m]

  Eigen::Index size() const { return points.cols(); }
};

/// n samples, each for the same area: sample k is where k + 1/2 of n parts of the area are before
/// it, in the order of the triangles, at a place in its triangle from a sequence of low
/// discrepancy. It depends on the mesh alone, not on where it lies in space. Checked by
/// tests/unit/planning/surface_samples_test.cc.
SurfaceSamples sample_surface(const SkinSurface& skin, int n);

/// Normals that are the mean of those of `fine` within `radius` of each sample.
void smooth_normals(SurfaceSamples& samples, const SurfaceSamples& fine, double radius);

}  // namespace lipofill::planning
