#include "core/geometry/surface_builder.h"

#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"

namespace lipofill::geometry {

absl::Status SurfaceBuilder::add_vertex(const std::array<double, 3>& xyz, const std::string& where) {
  for (const double x : xyz) {
    if (!std::isfinite(x)) {
      return absl::InvalidArgumentError(absl::StrCat(where, ": coordinate ", x, " is not a finite number"));
    }
  }
  if (n_vertices() >= limits_.max_vertices) {
    return absl::InvalidArgumentError(
        absl::StrCat(where, ": more than ", limits_.max_vertices, " vertices, the most accepted"));
  }
  coordinates_.insert(coordinates_.end(), xyz.begin(), xyz.end());
  return absl::OkStatus();
}

absl::Status SurfaceBuilder::add_polygon(const std::vector<long long>& corners, const std::string& where) {
  if (corners.size() < 3) {
    return absl::InvalidArgumentError(
        absl::StrCat(where, ": a face of ", corners.size(), " corners, must have 3 or more"));
  }
  for (const long long corner : corners) {
    if (corner < 0 || corner >= std::numeric_limits<int>::max()) {
      return absl::InvalidArgumentError(
          absl::StrCat(where, ": a face names vertex ", corner, " counted from 0, must be in [0, ", n_vertices(), ")"));
    }
  }
  if (triangles_.size() + corners.size() - 2 > static_cast<size_t>(limits_.max_triangles)) {
    return absl::InvalidArgumentError(
        absl::StrCat(where, ": more than ", limits_.max_triangles, " triangles, the most accepted"));
  }
  for (size_t k = 2; k < corners.size(); ++k) {
    triangles_.push_back(
        {static_cast<int>(corners[0]), static_cast<int>(corners[k - 1]), static_cast<int>(corners[k])});
  }
  return absl::OkStatus();
}

absl::StatusOr<SurfaceMesh> SurfaceBuilder::build() && {
  if (triangles_.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("the file has ", n_vertices(), " vertices and no face; a surface needs at least one"));
  }
  for (size_t t = 0; t < triangles_.size(); ++t) {
    for (const int corner : triangles_[t]) {
      if (corner < n_vertices()) continue;
      return absl::InvalidArgumentError(absl::StrCat("triangle ", t, " of the file names vertex ", corner,
                                                     " counted from 0, must be in [0, ", n_vertices(), ")"));
    }
  }
  SurfaceMesh mesh;
  mesh.points = Eigen::Map<const Eigen::Matrix3Xd>(coordinates_.data(), 3, n_vertices());
  mesh.triangles = std::move(triangles_);
  return mesh;
}

}  // namespace lipofill::geometry
