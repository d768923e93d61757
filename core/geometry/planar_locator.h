#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace lipofill::geometry {

/// Finds the triangle of a flattened patch that holds a point of the plane. Only triangles turned
/// the right way take part.
class PlanarLocator {
 public:
  PlanarLocator(const Eigen::Matrix2Xd& points, const std::vector<std::array<int, 3>>& triangles);

  struct Place {
    int triangle = -1;  ///< -1: no triangle there
    Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  };
  Place find(const Eigen::Vector2d& point) const;

 private:
  std::array<int, 2> bin_of(const Eigen::Vector2d& point) const;

  const Eigen::Matrix2Xd& points_;
  const std::vector<std::array<int, 3>>& triangles_;
  Eigen::Vector2d low_;
  double bin_size_ = 1.0;
  std::array<int, 2> n_bins_{1, 1};
  std::vector<std::vector<int>> bins_;
};

/// Twice the area of a triangle of the plane, positive when anticlockwise.
double compute_signed_area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

}  // namespace lipofill::geometry
