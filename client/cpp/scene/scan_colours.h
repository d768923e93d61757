#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// The points of a scan file and their colours.
struct ColouredPoints {
  Eigen::Matrix3Xd points_mm;
  Eigen::Matrix3Xf colours;  ///< 0 to 1, as screens show them
};

/// Reads the colours of vertices of a .ply (red, green, blue), an .obj (v x y z r g b) or a .glb or
/// .gltf (COLOR_0). INVALID_ARGUMENT, naming the file, for one without colours. Checked by
/// tests/unit/client/scan_colours_test.cc.
/// @param mm  millimetres a unit of the file; of glTF see gltf_unit_mm
absl::StatusOr<ColouredPoints> read_scan_colours(const std::filesystem::path& file, double mm);

/// The colours of the nearest points: a model cleans its scan, so vertices have other numbers, but
/// lie where they lay. INVALID_ARGUMENT where more than a twentieth of the points have none within
/// a millimetre: the colours are then of another scan.
absl::StatusOr<Eigen::Matrix3Xf> find_nearest_colours(const ColouredPoints& scan, const Eigen::Matrix3Xd& points_mm);

}  // namespace lipofill::client
