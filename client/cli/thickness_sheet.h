#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/cpp/frame_watcher.h"
#include "client/cpp/picture/thickness_picture.h"
#include "client/cpp/volume/tissue_thickness.h"

namespace lipofill::client {

/// The thickness of one layer at each node of the skin, and what was found on the way.
struct MeasuredLayer {
  std::string name;
  Eigen::VectorXd thickness_mm;  ///< NaN where it was not measured: the default stands there
  std::vector<Unmeasured> why;
  double thin_share = 0.0;  ///< of the nodes that are measured: thinner than the least, which stands for it
  double deep_share = 0.0;  ///< deeper than the greatest, which stands for it
};

/// A sheet is what a measurement found, for files and people.
struct ThicknessSheet {
  std::vector<MeasuredLayer> layers;
  std::vector<std::string> untouched;  ///< layers that stay as the plan has them
  std::vector<std::string> remarks;
  std::optional<std::array<double, 3>> up;
};

/// Shares and spread of each layer: mean, standard deviation, quantiles [mm].
nlohmann::ordered_json figures_of(const ThicknessSheet& sheet);

/// The same for people.
std::string describe(const ThicknessSheet& sheet);

/// Writes thickness.json and, of the skin of a model, thickness.vtp with a field
/// "thickness_LAYER_mm" a layer, not a number where it was not measured.
absl::Status write_thickness(const ThicknessSheet& sheet, const Meshes& meshes, const std::filesystem::path& folder);

/// Reads what a map is drawn of from that folder.
absl::StatusOr<ThicknessPicture> read_thickness_picture(const std::filesystem::path& folder);

}  // namespace lipofill::client
