#include "client/cli/report_pictures.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/picture.h"
#include "client/cli/process.h"
#include "client/cli/report_axes.h"
#include "client/cli/report_meshes.h"
#include "client/cpp/json_file.h"
#include "client/cpp/picture/colours.h"

namespace lipofill::client {
namespace {

using nlohmann::ordered_json;

constexpr int kColoursOfScale = 24;

std::string css_of(const Colour& colour) {
  const auto byte = [](double share) { return static_cast<int>(std::lround(255.0 * share)); };
  return absl::StrFormat("#%02x%02x%02x", byte(colour[0]), byte(colour[1]), byte(colour[2]));
}

std::vector<std::string> css_of(vtkColorTransferFunction* colours) {
  const double* range = colours->GetRange();
  std::vector<std::string> css;
  for (int k = 0; k < kColoursOfScale; ++k) {
    Colour colour{};
    colours->GetColor(range[0] + (range[1] - range[0]) * (k + 0.5) / kColoursOfScale, colour.data());
    css.push_back(css_of(colour));
  }
  return css;
}

/// The pictures that are asked of the process that draws.
ordered_json asked_pictures(bool has_target, bool has_deficit, const ReportScales& scales) {
  auto pictures = ordered_json::array();
  std::vector<std::string> shapes = {"before", "planned", "remaining"};
  if (has_target) shapes.emplace_back("target");
  for (const std::string& shape : shapes) {
    for (size_t side = 0; side < kViewNames.size(); ++side) {
      pictures.push_back({{"name", absl::StrCat(shape, "-", kViewNames[side])},
                          {"mesh", shape + ".vtp"},
                          {"paint", "skin"},
                          {"side", side}});
    }
  }
  pictures.push_back({{"name", "displacement-map"},
                      {"mesh", "planned.vtp"},
                      {"paint", "displacement"},
                      {"largest", scales.displacement_mm}});
  pictures.push_back({{"name", "pressure-map"}, {"mesh", "planned.vtp"}, {"paint", "pressure"}});
  std::vector<std::string> distances;
  if (has_deficit) distances.emplace_back("deficit");
  if (has_target) distances.insert(distances.end(), {"planned-distance", "remaining-distance"});
  for (const std::string& distance : distances) {
    pictures.push_back({{"name", distance + "-map"},
                        {"mesh", distance + ".vtp"},
                        {"paint", "distance"},
                        {"largest", scales.distance_mm},
                        {"line_step", scales.line_mm}});
  }
  return pictures;
}

ordered_json request_of(const ReportFetch& fetch, const WrittenMeshes& meshes) {
  const ReportAnswers& answers = fetch.answers();
  const Axes axes = axes_to_draw(answers.model.spec());
  ordered_json request = {{"axes", {{"left", axes.left}, {"up", axes.up}, {"forward", axes.forward}}},
                          {"is_face", answers.scan.has_value()}};
  if (meshes.centre) request["centre"] = *meshes.centre;
  request["pictures"] = asked_pictures(answers.target.has_value(), answers.deficit.has_value(), meshes.scales);
  return request;
}

/// Draws into a folder, and reads what was drawn.
absl::Status draw(const ReportFetch& fetch, ReportPictures& pictures) {
  const TemporaryFolder folder;
  const auto meshes = write_report_meshes(fetch, folder.path());
  if (!meshes.ok()) return meshes.status();
  const ordered_json request = request_of(fetch, *meshes);
  if (auto written = write_text_file(folder.path() / "pictures.json", request.dump()); !written.ok()) return written;
  const absl::Status drawn = draw_picture(folder.path(), Picture::kReport, folder.path() / "all.png");
  if (!drawn.ok()) return drawn;
  for (const ordered_json& picture : request.at("pictures")) {
    const std::string name = picture.at("name");
    auto png = read_text_file(folder.path() / (name + ".png"));
    if (!png.ok()) return png.status();
    pictures.png[name] = *std::move(png);
  }
  pictures.largest_displacement_mm = meshes->scales.displacement_mm;
  pictures.largest_distance_mm = meshes->scales.distance_mm;
  pictures.distance_line_mm = meshes->scales.line_mm;
  pictures.displacement_colours = css_of(displacement_colours(meshes->scales.displacement_mm));
  pictures.distance_colours = css_of(distance_colours(meshes->scales.distance_mm));
  return absl::OkStatus();
}

}  // namespace

ReportPictures draw_report_pictures(const ReportFetch& fetch) {
  ReportPictures pictures;
  for (size_t band = 0; band < kPressureBands.size(); ++band) {
    pictures.band_colours[band] = css_of(kPressureBands[band].colour);
  }
  const absl::Status drawn = draw(fetch, pictures);
  if (!drawn.ok()) pictures.problem = std::string(drawn.message());
  return pictures;
}

}  // namespace lipofill::client
