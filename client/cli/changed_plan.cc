#include "client/cli/changed_plan.h"

#include <optional>
#include <system_error>

namespace lipofill::client {

v1::Plan plan_file_of(const PlanFile& from, const v1::Model& model, const v1::SimulationSpec& changed,
                      const std::filesystem::path& folder) {
  v1::Plan plan = from.plan;
  const auto name_from_there = [&](const std::optional<std::filesystem::path>& file, v1::ScanFile* scan) {
    if (!file) return;
    std::error_code error;
    const auto relative = std::filesystem::relative(*file, folder, error);
    scan->set_file(error || relative.empty() ? std::filesystem::absolute(*file).string() : relative.string());
    scan->clear_landmarks_file();  // the model has them
  };
  if (from.scan_file) name_from_there(from.scan_file, plan.mutable_scan());
  if (from.bone_file) name_from_there(from.bone_file, plan.mutable_bone());
  *plan.mutable_model() = model.spec();
  if (plan.model().has_scan_region()) {
    plan.mutable_model()->mutable_scan_region()->clear_scan();
    plan.mutable_model()->mutable_scan_region()->clear_bone_scan();
  }
  *plan.mutable_simulation() = changed;
  plan.mutable_simulation()->clear_model();
  return plan;
}

}  // namespace lipofill::client
