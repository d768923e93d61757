#pragma once

#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "client/cpp/picture/surface.h"
#include "client/cpp/picture/view.h"

namespace lipofill::client {

/// The paint is what a picture shows on a face.
enum class FacePaint {
  kSkin,      ///< the skin as it is
  kMovement,  ///< its movement, from the field "displacement_mm"
  kBands,     ///< the fat below in bands of pressure, from "pressure_pa" and "thickness_mm"
  kDistance,  ///< its distance from a target, from "distance_mm", with lines
};

struct FacePicture {
  Surface surface;
  FacePaint paint = FacePaint::kSkin;
  View view;
  double largest = 1.0;    ///< end of the colours [mm]
  double line_step = 1.0;  ///< between lines of distance [mm]
  std::filesystem::path png;
};

inline constexpr int kFacePictureWidth = 520;
inline constexpr int kFacePictureHeight = 560;

/// Draws a face and nothing beside it, 520 x 560 pixels: what there is to say stands in the report.
/// Lines of distance are dark where skin is missing and white where it is too much, so that the two
/// are told apart without colour. Needs an X server, as draw_result_picture(). INVALID_ARGUMENT for
/// a surface without the fields that the paint needs. Checked by
/// tests/integration/cli/report_test.cc.
absl::Status draw_face_picture(const FacePicture& picture);

}  // namespace lipofill::client
