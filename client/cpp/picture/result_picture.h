#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "absl/status/status.h"

namespace lipofill::client {

/// What to draw of a surface that rode on a simulation: a .vtp with the point field "displacement_mm" and, for
/// `kDistance`, "distance_mm".
struct PictureRequest {
  std::filesystem::path mesh;
  std::filesystem::path png;
  /// Which way is up in the mesh's frame; none: estimated from the surface.
  std::optional<std::array<double, 3>> up;
  /// A line under the panels.
  std::string caption;
};

/// Before, after and displacement side by side: three panels of one camera that looks from outside at what moved, the
/// surface in the colour of skin, the displacement in mm with a legend. 2100 x 800 pixels. Draws off the screen, but
/// needs an X server: without one VTK ends the process, so call it in a process of its own. INVALID_ARGUMENT for a mesh
/// that cannot be read or has no displacement. Checked by tests/integration/cli/.
absl::Status draw_result_picture(const PictureRequest& request);

/// Before, after and the signed distance to the target (blue inside, red outside): the paper's Figure 2. Points whose
/// "distance_mm" is not a number lie outside the region and stay in the colour of skin.
absl::Status draw_distance_picture(const PictureRequest& request);

}  // namespace lipofill::client
