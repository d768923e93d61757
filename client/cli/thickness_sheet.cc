#include "client/cli/thickness_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/cpp/io/mesh_files.h"
#include "client/cpp/json_file.h"
#include "client/cpp/result_text.h"

namespace lipofill::client {
namespace {

constexpr char kFigures[] = "thickness.json";
constexpr char kMesh[] = "thickness.vtp";

std::string field_of(const std::string& layer) {
  // A dot would part the name of an array anew.
  return absl::StrCat("thickness_", absl::StrReplaceAll(layer, {{".", "_"}}));
}

/// The measured values in ascending order.
std::vector<double> sorted_values(const MeasuredLayer& layer) {
  std::vector<double> values;
  for (const double value : layer.thickness_mm) {
    if (std::isfinite(value)) values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  return values;
}

double share_of(const MeasuredLayer& layer, Unmeasured why) {
  return static_cast<double>(std::count(layer.why.begin(), layer.why.end(), why)) /
         static_cast<double>(layer.why.size());
}

double quantile(const std::vector<double>& sorted, double part) {
  const double at = part * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<size_t>(at);
  const size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (at - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

/// The mean and the standard deviation.
std::array<double, 2> moments(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  const double mean = sum / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, std::sqrt(squares / static_cast<double>(values.size()))};
}

nlohmann::ordered_json figures_of(const MeasuredLayer& layer) {
  const std::vector<double> values = sorted_values(layer);
  const double measured = static_cast<double>(values.size()) / static_cast<double>(layer.why.size());
  nlohmann::ordered_json figures = {{"name", layer.name},
                                    {"measured_share", measured},
                                    {"default_share", 1.0 - measured},
                                    {"scan_ends_share", share_of(layer, Unmeasured::kScanEnds)},
                                    {"metal_share", share_of(layer, Unmeasured::kMetal)},
                                    {"not_met_share", share_of(layer, Unmeasured::kNotMet)},
                                    {"thin_share", layer.thin_share},
                                    {"deep_share", layer.deep_share}};
  if (values.empty()) return figures;
  const auto [mean, deviation] = moments(values);
  figures["mean_mm"] = mean;
  figures["standard_deviation_mm"] = deviation;
  figures["least_mm"] = values.front();
  figures["percentile_5_mm"] = quantile(values, 0.05);
  figures["median_mm"] = quantile(values, 0.5);
  figures["percentile_95_mm"] = quantile(values, 0.95);
  figures["greatest_mm"] = values.back();
  return figures;
}

std::string line_of(const nlohmann::ordered_json& layer) {
  const std::string measured = absl::StrFormat("%.0f %% measured", 100.0 * layer["measured_share"].get<double>());
  if (!layer.contains("mean_mm")) return measured;
  return absl::StrFormat("%.1f mm (sd %.1f, 90 %% within %.1f to %.1f), %s", layer["mean_mm"].get<double>(),
                         layer["standard_deviation_mm"].get<double>(), layer["percentile_5_mm"].get<double>(),
                         layer["percentile_95_mm"].get<double>(), measured);
}

/// Why the rest was not measured: "scan ends 3 %, metal 2 %".
std::string reasons_of(const nlohmann::ordered_json& layer) {
  std::string text;
  for (const auto& [key, words] : {std::pair{"scan_ends_share", "the scan ends"},
                                   {"metal_share", "metal is near"},
                                   {"not_met_share", "nothing was met"}}) {
    const double share = layer[key].get<double>();
    if (share > 0.0) absl::StrAppendFormat(&text, "%s%s at %.1f %%", text.empty() ? "" : ", ", words, 100.0 * share);
  }
  return text;
}

Array field_array(const MeasuredLayer& layer) {
  Array array;
  array.name = absl::StrCat("skin.", field_of(layer.name));
  array.unit = "mm";
  array.location = ArrayLocation::kPoint;
  array.type = ElementType::kFloat32;
  array.shape = {static_cast<size_t>(layer.thickness_mm.size())};
  const Eigen::VectorXf values = layer.thickness_mm.cast<float>();
  array.bytes.resize(static_cast<size_t>(values.size()) * sizeof(float));
  std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
  return array;
}

}  // namespace

nlohmann::ordered_json figures_of(const ThicknessSheet& sheet) {
  auto layers = nlohmann::ordered_json::array();
  for (const MeasuredLayer& layer : sheet.layers) layers.push_back(figures_of(layer));
  nlohmann::ordered_json figures = {{"layers", layers}, {"untouched", sheet.untouched}, {"remarks", sheet.remarks}};
  if (sheet.up) figures["up"] = *sheet.up;
  return figures;
}

std::string describe(const ThicknessSheet& sheet) {
  std::string text;
  for (const MeasuredLayer& layer : sheet.layers) {
    const auto figures = figures_of(layer);
    absl::StrAppendFormat(&text, "  %-14s %s\n", layer.name, line_of(figures));
    const std::string reasons = reasons_of(figures);
    if (!reasons.empty()) absl::StrAppend(&text, "                 the default stands: ", reasons, "\n");
    if (layer.thin_share > 0.0 || layer.deep_share > 0.0) {
      absl::StrAppendFormat(&text, "                 thinner than can be modelled at %.1f %%, deeper at %.1f %%\n",
                            100.0 * layer.thin_share, 100.0 * layer.deep_share);
    }
  }
  for (const std::string& name : sheet.untouched)
    absl::StrAppendFormat(&text, "  %-14s as the plan has it: the volume does not show it\n", name);
  for (const std::string& remark : sheet.remarks) absl::StrAppend(&text, "  remark: ", remark, "\n");
  return text;
}

absl::Status write_thickness(const ThicknessSheet& sheet, const Meshes& meshes, const std::filesystem::path& folder) {
  std::vector<Array> fields;
  for (const MeasuredLayer& layer : sheet.layers) fields.push_back(field_array(layer));
  const auto views = mesh_views(meshes.arrays, fields);
  if (!views.ok()) return views.status();
  for (const MeshView& view : *views) {
    if (view.name != "skin") continue;
    if (auto written = write_mesh(folder / kMesh, view); !written.ok()) return written;
  }
  return write_text_file(folder / kFigures, figures_of(sheet).dump(2) + "\n");
}

absl::StatusOr<ThicknessPicture> read_thickness_picture(const std::filesystem::path& folder) {
  const auto figures = read_json_file(folder / kFigures);
  if (!figures.ok()) return figures.status();
  ThicknessPicture picture;
  picture.mesh = folder / kMesh;
  picture.title = "Thickness of the layers as measured";
  picture.caption = kNotAMedicalDevice;
  for (const auto& layer : figures->at("layers")) {
    const auto name = layer.at("name").get<std::string>();
    picture.maps.push_back({absl::StrCat(field_of(name), "_mm"), name, line_of(nlohmann::ordered_json(layer))});
    const std::string reasons = reasons_of(nlohmann::ordered_json(layer));
    if (!reasons.empty()) picture.remarks.push_back(absl::StrCat(name, ": the default stands where ", reasons));
  }
  if (figures->contains("up")) picture.up = figures->at("up").get<std::array<double, 3>>();
  return picture;
}

}  // namespace lipofill::client
