#include "client/cpp/plan_file.h"

#include <algorithm>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/errors.h"
#include "client/cpp/json_message.h"
#include "client/cpp/landmarks_file.h"

namespace lipofill::client {

absl::StatusOr<PlanFile> load_plan(const std::filesystem::path& path) {
  PlanFile file;
  file.path = path;
  if (auto status = load_message(path, &file.plan); !status.ok()) return status;
  const std::filesystem::path folder = path.parent_path();
  const v1::ScanFile& scan = file.plan.scan();
  if (!scan.file().empty()) file.scan_file = folder / scan.file();
  if (!file.plan.bone().file().empty()) file.bone_file = folder / file.plan.bone().file();
  if (!scan.landmarks_file().empty()) file.landmarks_file = (folder / scan.landmarks_file()).string();
  return file;
}

absl::Status check_bone_file(const PlanFile& plan) {
  std::vector<FieldViolation> problems;
  if (!plan.plan.bone().landmarks_file().empty()) {
    problems.push_back({"bone.landmarks_file", "is given, but landmarks are those of the scan"});
  }
  if (plan.bone_file && !plan.plan.model().has_scan_region()) {
    problems.push_back({"bone.file", "is given, but model.scan_region is not"});
  }
  if (problems.empty()) return absl::OkStatus();
  return invalid_fields(absl::StrCat(plan.path.string(), ": a bone that cannot be used"), problems);
}

std::string display_name_of(const std::string& plan_name) {
  constexpr size_t kMost = 63;
  std::string name = absl::AsciiStrToLower(plan_name).substr(0, kMost);
  for (char& c : name) {
    if (!absl::ascii_isdigit(static_cast<unsigned char>(c)) && !(c >= 'a' && c <= 'z')) c = '-';
  }
  return name;
}

absl::Status load_plan_landmarks(PlanFile* plan) {
  if (!plan->landmarks_file) return absl::OkStatus();
  if (!plan->plan.model().has_scan_region()) {
    return invalid_fields(absl::StrCat(plan->path.string(), ": landmarks without a scan region"),
                          {{"scan.landmarks_file", "is given, but model.scan_region is not"}});
  }
  const auto landmarks = load_landmarks(*plan->landmarks_file, plan->plan.scan().unit());
  if (!landmarks.ok()) return landmarks.status();
  set_landmarks(*landmarks, plan->plan.mutable_model()->mutable_scan_region());
  plan->landmark_remarks = landmarks->remarks;
  return absl::OkStatus();
}

void take_region_from_zones(v1::Plan* plan) {
  if (!plan->model().has_scan_region()) return;
  v1::ScanRegion& region = *plan->mutable_model()->mutable_scan_region();
  if (region.corners_size() > 0 || region.around().regions_size() > 0 || region.around().discs_size() > 0) return;
  for (const v1::Film& film : plan->simulation().films()) {
    for (const v1::Zone& zone : film.zones()) {
      if (zone.has_region()) {
        auto& names = *region.mutable_around()->mutable_regions();
        if (std::find(names.begin(), names.end(), zone.region()) == names.end()) names.Add()->assign(zone.region());
      } else if (zone.has_disc() && !zone.disc().centre().has_chart()) {
        v1::SkinDisc& disc = *region.mutable_around()->add_discs();
        *disc.mutable_centre() = zone.disc().centre();
        if (zone.disc().has_radius_mm()) disc.set_radius_mm(zone.disc().radius_mm());
      }
    }
  }
}

}  // namespace lipofill::client
