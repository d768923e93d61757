#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/application.h"
#include "client/cli/private_daemon.h"
#include "client/cli/progress_line.h"
#include "client/cli/run_record.h"
#include "client/cpp/frame_watcher.h"
#include "client/cpp/io/result_folder.h"
#include "client/cpp/plan_file.h"
#include "lipofill/v1/patient_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::client {

struct RunOptions {
  std::string plan;
  std::string out;
  std::string patient;    ///< is one on the daemon; where it is empty, one is made
  std::string scan;       ///< takes the place of the plan's
  std::string bone;       ///< takes the place of the plan's
  std::string landmarks;  ///< takes the place of the plan's
  std::optional<v1::ScanUnit> unit;
  std::optional<double> interval_ms;
  bool preview = false;  ///< a coarse model's settled shape first
  std::string evaluate;  ///< a target surface; empty: none
  v1::ScanUnit target_unit = v1::MILLIMETRE;
  bool spawn = false;
  bool fast = false;  ///< the settled shape in few steps, in place of the plan's steps
  bool keep = true;
  bool picture = true;
  bool quiet = false;
};

/// A plan carried out on a daemon from scan to result: each member function is one step, in their
/// order in `carry_out`.
class Run {
 public:
  Run(Application& application, RunOptions options);

  absl::StatusOr<ExitCode> carry_out();

 private:
  absl::Status read_plan();
  absl::Status reach_daemon();
  absl::Status prepare_patient();
  absl::Status send_scan();
  absl::StatusOr<v1::Scan> send_surface(const std::filesystem::path& file, v1::ScanUnit unit, const char* what);
  absl::Status build();
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
  ResultFolder folder_;
  RunRecord record_;
  PlanFile plan_;
  std::unique_ptr<PrivateDaemon> daemon_;
  std::optional<Connection> connection_;
  std::string patient_;
  bool made_patient_ = false;
  v1::ModelSpec model_spec_;
  v1::Model model_;
  v1::Simulation simulation_;
  bool preview_told_ = false;
  std::vector<v1::SeriesRow> rows_;
};

}  // namespace lipofill::client
