#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/application.h"
#include "client/cli/progress_line.h"
#include "client/cli/run_ground.h"
#include "client/cli/run_record.h"
#include "client/cpp/frame_watcher.h"
#include "client/cpp/io/result_folder.h"
#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

struct RunOptions : GroundOptions {
  std::optional<double> interval_ms;
  bool preview = false;  ///< a coarse model's settled shape first
  std::string evaluate;  ///< a target surface; empty: none
  v1::ScanUnit target_unit = v1::MILLIMETRE;
  bool fast = false;  ///< the settled shape in few steps, in place of the plan's steps
  bool keep = true;
  bool picture = true;
  bool quiet = false;
};

/// The settled shape in as few steps as it takes: the goal's own step lengths and tolerance in
/// place of the plan's.
void aim_at_settled_shape(v1::TimeControl& time);

/// A plan carried out on a daemon from scan to result: each member function is one step, in their
/// order in `carry_out`.
class Run {
 public:
  Run(Application& application, RunOptions options);

  absl::StatusOr<ExitCode> carry_out();

 private:
  absl::Status read_plan();
  absl::Status prepare_ground();
  absl::Status create_simulation();
  absl::Status simulate();
  absl::Status write_results();
  absl::Status evaluate();
  void draw();
  void clean_up();

  v1::WatchRequest watch_request() const;
  absl::Status take_frames(const v1::WatchRequest& request, const std::function<void()>& on_watching);
  absl::Status start_and_follow(const std::stop_token& frames_ended);
  void show_progress();
  void tell_preview();
  void stop_simulation();
  void print_summary() const;
  ExitCode exit_code() const;

  Application& application_;
  const RunOptions options_;
  ProgressLine progress_;
  RunGround ground_;
  ResultFolder folder_;
  RunRecord record_;
  v1::Simulation simulation_;
  bool preview_told_ = false;
  std::vector<v1::SeriesRow> rows_;
};

}  // namespace lipofill::client
