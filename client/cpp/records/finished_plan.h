#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// A film of fat as a result has it: quadrilaterals half-way between its walls, where these are in
/// the end, with "thickness_mm" on its cells.
struct PlannedFilm {
  std::string name;
  vtkSmartPointer<vtkPolyData> cells;
};

/// This is what a folder of results says of a plan that has ended.
struct FinishedPlan {
  std::string name;
  nlohmann::json summary;             ///< summary.json
  nlohmann::json evaluation;          ///< evaluation.json; null where there is none
  vtkSmartPointer<vtkPolyData> skin;  ///< [mm] the whole scan, or the model's skin, as it is in the end
  std::vector<PlannedFilm> films;
  std::chrono::system_clock::time_point finished;  ///< when summary.json was written
};

/// Reads the last state of a folder that `lipofill run` or `lipofill export` has written.
/// INVALID_ARGUMENT for another folder, FAILED_PRECONDITION for a plan that has not SETTLED or
/// FINISHED. Checked by tests/unit/client/records_test.cc.
absl::StatusOr<FinishedPlan> read_finished_plan(const std::filesystem::path& folder);

}  // namespace lipofill::client
