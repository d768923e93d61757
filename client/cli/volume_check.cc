#include "client/cli/volume_check.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/dicom/any_volume.h"
#include "client/cpp/dicom/dicom_source.h"
#include "client/cpp/volume/tissue_labels.h"
#include "client/cpp/volume/volume_facts.h"

namespace lipofill::client {
namespace {

nlohmann::ordered_json labels_of(const Volume& volume, const VolumeFacts& facts) {
  auto labels = nlohmann::ordered_json::array();
  for (const auto& [label, voxels] : facts.labels) {
    nlohmann::ordered_json entry = {
        {"label", label}, {"voxels", voxels}, {"volume_ml", facts.voxel_ml * static_cast<double>(voxels)}};
    if (const auto name = volume.label_names.find(label); name != volume.label_names.end()) {
      entry["name"] = name->second;
      if (const auto tissue = tissue_named(name->second)) entry["tissue"] = name_of(*tissue);
    }
    labels.push_back(std::move(entry));
  }
  return labels;
}

/// Tells what a DICOM source holds beside the volume that was read.
void add_listing(const std::filesystem::path& source, nlohmann::ordered_json* found) {
  const auto listing = list_dicom(source);
  if (!listing.ok()) return;
  auto series = nlohmann::ordered_json::array();
  for (const DicomSeries& each : listing->series) {
    nlohmann::ordered_json entry = {{"series", each.label()}, {"description", each.description}};
    if (!each.problem.empty()) entry["problem"] = each.problem;
    series.push_back(std::move(entry));
  }
  (*found)["series"] = series;
  (*found)["patients"] = listing->patients;
  (*found)["files_without_image"] = listing->without_image;
  (*found)["other_files"] = listing->other_files;
  (*found)["unreadable_files"] = listing->unreadable_files;
}

}  // namespace

bool holds_a_volume(const std::filesystem::path& source) {
  return is_volume_name(source) || DicomSource::is_dicom(source);
}

absl::StatusOr<nlohmann::ordered_json> check_volume(const std::filesystem::path& source, const std::string& series,
                                                    const std::filesystem::path& png) {
  const auto volume = read_any_volume(source, {series, false});
  if (!volume.ok()) return volume.status();
  const VolumeFacts facts = find_volume_facts(*volume);
  nlohmann::ordered_json found = {{"size", facts.size},
                                  {"spacing_mm", facts.spacing_mm},
                                  {"frame", facts.frame},
                                  {"least_value", facts.values.least},
                                  {"greatest_value", facts.values.most},
                                  {"isovalue_to_try", facts.values.threshold},
                                  {"labels", labels_of(*volume, facts)},
                                  {"remarks", volume->remarks}};
  if (!is_volume_name(source)) add_listing(source, &found);
  if (!png.empty()) {
    if (auto drawn = draw_slices(*volume, facts, png); !drawn.ok()) return drawn;
  }
  return found;
}

std::string describe_volume(const nlohmann::ordered_json& found) {
  const auto& size = found["size"];
  const auto& spacing = found["spacing_mm"];
  std::string text =
      absl::StrFormat("  volume    %d x %d x %d voxels of %.4g x %.4g x %.4g mm, axes: %s\n  values    %g to %g\n",
                      size[0].get<int>(), size[1].get<int>(), size[2].get<int>(), spacing[0].get<double>(),
                      spacing[1].get<double>(), spacing[2].get<double>(), found["frame"].get<std::string>(),
                      found["least_value"].get<double>(), found["greatest_value"].get<double>());
  for (const auto& label : found["labels"]) {
    const std::string name = label.value("name", ""), tissue = label.value("tissue", "");
    absl::StrAppendFormat(&text, "  label     %d%s: %.2f mL%s\n", label["label"].get<int64_t>(),
                          name.empty() ? "" : absl::StrCat(" (", name, ")"), label["volume_ml"].get<double>(),
                          tissue.empty() ? "" : absl::StrCat(", taken for ", tissue));
  }
  if (found.contains("series")) {
    for (const auto& series : found["series"]) {
      absl::StrAppendFormat(&text, "  series    %s  %s\n", series["series"].get<std::string>(),
                            series["description"].get<std::string>());
      if (series.contains("problem"))
        absl::StrAppend(&text, "            no volume: ", series["problem"].get<std::string>(), "\n");
    }
    absl::StrAppendFormat(&text, "  files     without an image %d, of other kinds %d, cut short %d; patients %d\n",
                          found["files_without_image"].get<size_t>(), found["other_files"].get<size_t>(),
                          found["unreadable_files"].get<size_t>(), found["patients"].get<size_t>());
  }
  for (const auto& remark : found["remarks"]) absl::StrAppend(&text, "  read      ", remark.get<std::string>(), "\n");
  return text;
}

}  // namespace lipofill::client
