#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cli/run_record.h"
#include "client/cpp/connection.h"
#include "lipofill/v1/plan.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

/// Record for a folder of results of a simulation that lives on a daemon at a lasting address.
absl::StatusOr<RunRecord> record_of_simulation(const Connection& connection, const v1::Simulation& simulation);

/// Writes series.csv and summary.json into a folder of results.
absl::Status write_figures(const std::filesystem::path& folder, const std::string& plan,
                           const v1::Simulation& simulation, const std::vector<v1::SeriesRow>& rows);

/// Writes the final state of a simulation that has ended, as a run would have: meshes, series,
/// summary and record.
/// @return what was done, for people
absl::StatusOr<std::string> export_result(const Connection& connection, const std::string& simulation,
                                          const std::filesystem::path& out);

/// Measures a simulation against a target and writes evaluation.json, distance.vtp and, where it
/// can be drawn, distance.png. `target` is a surface file, sent to the patient of the simulation's
/// model, or the name of a scan the daemon has.
/// @param picture_problem  out: why there is no picture; OK when there is one
absl::StatusOr<v1::Evaluation> evaluate_into(const std::filesystem::path& folder, const Connection& connection,
                                             const v1::Simulation& simulation, const std::string& target,
                                             v1::ScanUnit unit, absl::Status* picture_problem);

}  // namespace lipofill::client
