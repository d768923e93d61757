#pragma once

#include <string>
#include <vector>

#include "client/cli/report_options.h"
#include "client/cli/simulation_calls.h"
#include "client/cpp/report/answers.h"

namespace lipofill::client {

/// Asks a daemon for all that a report says. Each member function is one step, in their order in
/// fetch(). What the daemon cannot tell of this plan, a forecast of one that has to be stepped or
/// an injection list of one that takes fat out, is left out with its reason.
class ReportFetch {
 public:
  ReportFetch(RunGround& ground, ProgressLine& progress, const ReportOptions& options, v1::ForecastSpec spec)
      : ground_(ground), progress_(progress), options_(options), spec_(std::move(spec)) {}

  absl::Status fetch();
  /// Deletes the simulations that were made for it.
  void clean_up();

  const ReportAnswers& answers() const { return answers_; }
  const FinalState& planned() const { return planned_; }
  const FinalState& remaining() const { return remaining_; }
  /// Surfaces of the scan and the target as they were read; empty without a target.
  const std::vector<Array>& scan_mesh() const { return scan_mesh_; }
  const std::vector<Array>& target_mesh() const { return target_mesh_; }
  const std::vector<std::string>& simulations() const { return simulations_; }

 private:
  absl::Status take_plan();
  absl::Status make_target();
  absl::Status measure_target();
  absl::Status find_inputs();
  absl::Status simulate_plan();
  absl::Status forecast();
  absl::Status estimate_retention();
  absl::Status simulate_remaining();
  absl::Status list_delivery();

  v1::MakeForecastRequest forecast_request() const;
  absl::StatusOr<std::string> find_surface();
  absl::Status settle(const v1::SimulationSpec& spec, const std::string& what, ReportedShape& shape, FinalState& state);
  absl::Status follow(v1::Simulation& simulation, const std::string& what);

  RunGround& ground_;
  ProgressLine& progress_;
  const ReportOptions& options_;
  const v1::ForecastSpec spec_;
  ReportAnswers answers_;
  std::string target_scan_;
  FinalState planned_;
  FinalState remaining_;
  std::vector<Array> scan_mesh_;
  std::vector<Array> target_mesh_;
  std::vector<std::string> simulations_;
};

}  // namespace lipofill::client
