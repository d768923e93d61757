#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lipofill/v1/plan.pb.h"

namespace lipofill::client {

/// A plan as it is in its file, and where the files it names are.
struct PlanFile {
  std::filesystem::path path;
  v1::Plan plan;
  std::optional<std::filesystem::path> scan_file;
  std::optional<std::filesystem::path> bone_file;
  std::optional<std::string> landmarks_file;  ///< may end in #object
  std::vector<std::string> landmark_remarks;  ///< what load_plan_landmarks made of it, a sentence each
};

/// Reads a plan: the proto3 JSON form of lipofill.v1.Plan. Files it names are taken relative to it.
/// Fields are checked against the schema; what they mean is checked by the daemon. INVALID_ARGUMENT
/// naming the file, and as violations each unknown field by its path, with the nearest known name.
/// Checked by tests/unit/client/plan_file_test.cc.
absl::StatusOr<PlanFile> load_plan(const std::filesystem::path& path);

/// Refuses a bone file in a plan that has no scan region, or with landmarks of its own:
/// INVALID_ARGUMENT.
absl::Status check_bone_file(const PlanFile& plan);

/// A plan's name as the daemon takes it for dashboards: at most 63 characters of [a-z0-9-].
std::string display_name_of(const std::string& plan_name);

/// Puts the landmarks file's landmarks and axes into the plan's scan region; does nothing without
/// one.
absl::Status load_plan_landmarks(PlanFile* plan);

/// Lets the region of a scan follow from the zones, where the plan gives it neither corners nor
/// what it goes around: the named regions and the discs of all films, each once. Boxes and painted
/// zones lie on a chart that is not there yet. Does nothing where no zone tells.
void take_region_from_zones(v1::Plan* plan);

}  // namespace lipofill::client
