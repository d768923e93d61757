#include "client/cpp/records/finished_plan.h"

#include <vtkCellData.h>

#include <map>
#include <regex>

#include "absl/strings/str_cat.h"
#include "client/cpp/io/result_folder.h"
#include "client/cpp/io/vtp_file.h"
#include "client/cpp/json_file.h"

namespace lipofill::client {
namespace {

absl::StatusOr<vtkSmartPointer<vtkPolyData>> read_surface(const std::filesystem::path& file) {
  auto surface = read_vtp(file);
  if (surface.ok() && (*surface)->GetNumberOfCells() == 0) {
    return absl::InvalidArgumentError(absl::StrCat(file.string(), " cannot be read as a surface with cells"));
  }
  return surface;
}

/// The stems of the films in a folder, and what the films are called.
std::map<std::string, std::string> film_stems(const std::filesystem::path& folder) {
  static const std::regex pattern(R"((film(?:_(.+))?)_\d{4,}\.vtp)");
  std::map<std::string, std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string file = entry.path().filename().string();
    std::smatch match;
    if (std::regex_match(file, match, pattern)) names[match[1]] = match[2].matched ? match[2].str() : "film";
  }
  return names;
}

absl::Status read_films(const std::filesystem::path& folder, FinishedPlan* plan) {
  for (const auto& [stem, name] : film_stems(folder)) {
    const std::filesystem::path file = last_frame_file(folder, stem);
    auto cells = read_surface(file);
    if (!cells.ok()) return cells.status();
    if ((*cells)->GetCellData()->GetArray("thickness_mm") == nullptr)
      return absl::InvalidArgumentError(absl::StrCat(file.string(), " has no thickness_mm on its cells"));
    plan->films.push_back({name, *std::move(cells)});
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<FinishedPlan> read_finished_plan(const std::filesystem::path& folder) {
  FinishedPlan plan;
  auto summary = read_json_file(folder / "summary.json");
  if (!summary.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(
        folder.string(),
        " is not a folder that lipofill run or lipofill export has written: ", summary.status().message()));
  }
  plan.summary = *std::move(summary);
  plan.name = plan.summary.value("plan", "");
  const std::string state = plan.summary.value("state", "");
  if (state != "SETTLED" && state != "FINISHED") {
    return absl::FailedPreconditionError(absl::StrCat("the plan in ", folder.string(), " is ",
                                                      state.empty() ? "of no state" : state,
                                                      "; records are made of one that has SETTLED or FINISHED"));
  }
  std::error_code error;
  const auto written = std::filesystem::last_write_time(folder / "summary.json", error);
  plan.finished = std::chrono::file_clock::to_sys(written);
  if (std::filesystem::exists(folder / "evaluation.json")) {
    auto evaluation = read_json_file(folder / "evaluation.json");
    if (!evaluation.ok()) return evaluation.status();
    plan.evaluation = *std::move(evaluation);
  }
  std::filesystem::path skin = last_frame_file(folder, "scan");
  if (skin.empty()) skin = last_frame_file(folder, "skin");
  if (skin.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(folder.string(), " has no skin: neither scan_NNNN.vtp nor skin_NNNN.vtp is there"));
  }
  auto surface = read_surface(skin);
  if (!surface.ok()) return surface.status();
  plan.skin = *std::move(surface);
  if (auto status = read_films(folder, &plan); !status.ok()) return status;
  return plan;
}

}  // namespace lipofill::client
