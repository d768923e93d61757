#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

#include "absl/status/statusor.h"

namespace lipofill::geometry {

/// Landmark positions in the scan's frame [m]. Names as in anthropometry: nasion, pronasale,
/// subnasale, pogonion, menton and, with _left / _right, exocanthion, cheilion, gonion, zygion,
/// tragion.
using Landmarks = std::map<std::string, Eigen::Vector3d>;

/// Unit vectors of the head in the scan's frame; left is the subject's own. left = up x forward.
struct HeadAxes {
  Eigen::Vector3d left = Eigen::Vector3d::UnitX();
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();
};

/// Left from the pairs of left and right landmarks; up from menton (or pogonion) to nasion, made
/// orthogonal to it and freed from the usual lean of that line (2.8 degrees forward, 3.6 back for
/// pogonion); forward from both. Good to a few degrees. FAILED_PRECONDITION naming what is missing
/// when there is no pair or no two midline points. Checked by
/// tests/unit/geometry/head_axes_test.cc.
absl::StatusOr<HeadAxes> estimate_head_axes(const Landmarks& landmarks);

}  // namespace lipofill::geometry
