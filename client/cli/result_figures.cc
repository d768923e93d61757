#include "client/cli/result_figures.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "absl/strings/ascii.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/cpp/json_file.h"
#include "client/cpp/picture/colours.h"

namespace lipofill::client {
namespace {

/// So many zones have room for a heading each; more have a line each.
constexpr size_t kZonesWithHeading = 2;
constexpr size_t kMostZones = 7;

double number(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : std::nan("");
}

std::string text(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string pressure_text(double pressure_pa) {
  return absl::StrFormat("%.1f kPa, %.0f mmHg", 1e-3 * pressure_pa, pressure_pa / kPascalPerMmhg);
}

void add_zone(const std::string& name, const nlohmann::json& zone,
              std::vector<std::pair<std::string, std::string>>& figures) {
  figures.emplace_back(name, "");
  figures.emplace_back(
      "fat", absl::StrFormat("%.1f mL, up to %.1f mm", number(zone, "volume_ml"), number(zone, "max_thickness_mm")));
  figures.emplace_back("mean pressure", pressure_text(number(zone, "mean_pressure_pa")));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> figures_of_folder(const std::filesystem::path& folder) {
  const auto summary = read_json_file(folder / "summary.json");
  if (!summary.ok() || !summary->is_object()) return {};
  std::vector<std::pair<std::string, std::string>> figures = {
      {"Result", ""},
      {"fat injected", absl::StrFormat("%.1f mL", number(*summary, "injected_ml"))},
      {"skin moves by up to", absl::StrFormat("%.1f mm", number(*summary, "skin_max_displacement_mm"))},
      {"volume under the skin", absl::StrFormat("%+.1f mL", number(*summary, "skin_volume_change_ml"))},
      {absl::AsciiStrToLower(text(*summary, "state")), absl::StrFormat("after %.1f s", number(*summary, "time_s"))}};
  const auto zones = summary->find("zones");
  if (zones == summary->end() || !zones->is_array()) return figures;
  const bool has_headings = zones->size() <= kZonesWithHeading;
  if (!has_headings) figures.emplace_back("Zones", "");
  for (size_t i = 0; i < zones->size() && i < kMostZones; ++i) {
    const nlohmann::json& zone = (*zones)[i];
    if (!zone.is_object()) continue;
    const std::string name = absl::StrReplaceAll(text(zone, "name"), {{"_", " "}});
    if (has_headings) {
      add_zone(name, zone, figures);
    } else {
      figures.emplace_back(
          name, absl::StrFormat("%.1f mL, %.1f mm, %.0f mmHg", number(zone, "volume_ml"),
                                number(zone, "max_thickness_mm"), number(zone, "mean_pressure_pa") / kPascalPerMmhg));
    }
  }
  if (zones->size() > kMostZones) {
    figures.emplace_back("and others", absl::StrFormat("%d, in summary.json", zones->size() - kMostZones));
  }
  return figures;
}

std::vector<std::string> remarks_of_folder(const std::filesystem::path& folder) {
  const auto summary = read_json_file(folder / "summary.json");
  if (!summary.ok() || !summary->is_object()) return {};
  const auto found = summary->find("remarks");
  if (found == summary->end() || !found->is_array()) return {};
  std::vector<std::string> remarks;
  for (const nlohmann::json& remark : *found) {
    if (remark.is_string()) remarks.push_back(remark.get<std::string>());
  }
  return remarks;
}

}  // namespace lipofill::client
