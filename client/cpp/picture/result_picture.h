#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"

namespace lipofill::client {

/// Describes how to draw a surface that rode on a simulation: a .vtp with the point field
/// "displacement_mm" and, as the picture needs them, "pressure_pa" and "thickness_mm", or
/// "distance_mm".
struct PictureRequest {
  std::filesystem::path mesh;
  std::filesystem::path png;
  /// The upward direction in the mesh's frame; if none is given it is estimated from the surface.
  std::optional<std::array<double, 3>> up;
  std::string title;
  /// A line under the panels.
  std::string caption;
  /// Figures beside the panels: what, and how much; a heading where there is no second.
  std::vector<std::pair<std::string, std::string>> figures;
  /// Sentences under the panels: what to know before relying on the figures. The first six are
  /// shown, the others counted.
  std::vector<std::string> remarks;
};

/// Draws before, after, displacement and pressure on one sheet: four panels of one camera that
/// looks from outside at what moved, the displacement in mm with a scalar bar, the pressure of the
/// fat below in bands of mmHg, figures beside them. 2000 x 1480 pixels. Draws off the screen, but
/// needs an X server: without one VTK ends the process, so call it in a process of its own.
/// INVALID_ARGUMENT for a mesh that cannot be read or lacks a field. Checked by
/// tests/integration/cli/render_test.cc.
absl::Status draw_result_picture(const PictureRequest& request);

/// Draws before, after and the signed distance to the target (blue inside, red outside): the
/// paper's Figure 2. Points whose "distance_mm" is not a number lie outside the region and stay in
/// the colour of skin. 2100 x 800 pixels.
absl::Status draw_distance_picture(const PictureRequest& request);

}  // namespace lipofill::client
