#include "client/cli/deficit_sheet.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/cli/distance_fields.h"
#include "client/cli/picture.h"
#include "client/cli/process.h"
#include "client/cpp/io/mesh_files.h"
#include "client/cpp/json_file.h"
#include "client/cpp/landmarks_file.h"
#include "client/cpp/result_text.h"
#include "client/cpp/target_call.h"

namespace lipofill::client {
namespace {

constexpr size_t kMostRegions = 9;

/// Regions from the one that lacks most on.
std::vector<v1::RegionDeficit> find_worst(const v1::Deficit& deficit) {
  std::vector<v1::RegionDeficit> regions(deficit.regions().begin(), deficit.regions().end());
  std::stable_sort(regions.begin(), regions.end(), [](const v1::RegionDeficit& a, const v1::RegionDeficit& b) {
    return a.volume().deficit_ml() > b.volume().deficit_ml();
  });
  if (regions.size() > kMostRegions) regions.resize(kMostRegions);
  return regions;
}

nlohmann::ordered_json figures_of(const v1::Deficit& deficit) {
  auto figures = nlohmann::ordered_json::array();
  const auto add = [&figures](const std::string& what, const std::string& value) { figures.push_back({what, value}); };
  add("All skin that is compared", "");
  add("missing", absl::StrFormat("%.2f mL", deficit.all().volume().deficit_ml()));
  add("too much", absl::StrFormat("%.2f mL", deficit.all().volume().excess_ml()));
  add("deepest", absl::StrFormat("%.1f mm", deficit.all().max_deficit_mm()));
  add("rms", absl::StrFormat("%.2f mm", deficit.all().distance().rms_mm()));
  const std::vector<v1::RegionDeficit> regions = find_worst(deficit);
  if (!regions.empty()) add("Missing by region", "");
  for (const v1::RegionDeficit& region : regions) {
    add(absl::StrReplaceAll(region.region(), {{"_", " "}}),
        absl::StrFormat("%.2f mL, %.1f mm", region.volume().deficit_ml(), region.max_deficit_mm()));
  }
  return figures;
}

}  // namespace

absl::Status draw_deficit_sheet(const Connection& connection, const v1::TargetSpec& target, const v1::Deficit& deficit,
                                const std::filesystem::path& png) {
  const auto arrays = download_scan_mesh(connection, target.scan());
  if (!arrays.ok()) return arrays.status();
  const std::vector<Array> fields = {distance_field(deficit)};
  const auto views = mesh_views(*arrays, fields);  // which point into both
  if (!views.ok()) return views.status();
  if (views->size() != 1) return absl::DataLossError("the daemon sent another number of meshes than one");
  const TemporaryFolder folder;
  if (auto written = write_mesh(folder.path() / kScanToDraw, views->front()); !written.ok()) return written;
  nlohmann::ordered_json text = {
      {"title", "What the face lacks to its target"},
      {"figures", figures_of(deficit)},
      {"remarks", std::vector<std::string>(deficit.remarks().begin(), deficit.remarks().end())}};
  v1::ScanRegion region;
  *region.mutable_landmarks_mm() = target.landmarks_mm();
  if (const auto up = up_of(region)) text["up"] = *up;
  if (auto written = write_text_file(folder.path() / kTextToDraw, text.dump()); !written.ok()) return written;
  return draw_picture(folder.path(), Picture::kDeficit, std::filesystem::absolute(png));
}

absl::StatusOr<PictureRequest> read_deficit_request(const std::filesystem::path& folder) {
  const auto text = read_json_file(folder / kTextToDraw);
  if (!text.ok()) return text.status();
  PictureRequest request;
  request.mesh = folder / kScanToDraw;
  request.caption = kNotAMedicalDevice;
  request.title = text->at("title").get<std::string>();
  for (const auto& figure : text->at("figures")) {
    request.figures.emplace_back(figure.at(0).get<std::string>(), figure.at(1).get<std::string>());
  }
  for (const auto& remark : text->at("remarks")) request.remarks.push_back(remark.get<std::string>());
  if (text->contains("up")) request.up = text->at("up").get<std::array<double, 3>>();
  return request;
}

}  // namespace lipofill::client
