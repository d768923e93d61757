// Measures the service: many sessions, many viewers, start-up. Tables go to the error output, JSON to the standard
// output.

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "absl/strings/str_format.h"
#include "tests/bench/service/served_plan.h"
#include "tests/bench/service/sessions_bench.h"
#include "tests/bench/service/startup_bench.h"
#include "tests/bench/service/viewers_bench.h"

namespace lipofill::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  PlanOptions plan{LIPOFILL_EXAMPLES "/plans/jaw_angle.json", "", ""};
  int workers = 2;
  std::vector<int> sessions = {1, 2, 4, 8};
  std::vector<int> viewers = {0, 1, 50};
  double simulated_s = 1.0;
  int rounds = 3;
  int refinements = 0;
  std::string format = "obj";
  bool in_process_only = false;
};

absl::StatusOr<Json> run_sessions(const client::PlanFile& plan, const Options& options) {
  Json rows = Json::array();
  absl::FPrintF(stderr, "%8s %8s %9s %9s %9s %9s %10s %8s %8s %9s %9s\n", "sessions", "workers", "steps/s", "a session",
                "fairness", "worker ms", "daemon ms", "busy", "threads", "made MB", "run MB");
  for (const int n : options.sessions) {
    const auto row = measure_sessions(plan, options.workers, n, options.simulated_s);
    if (!row.ok()) return row.status();
    const double per_s = row->steps / row->wall_s;
    const double busy = row->worker_cpu_s / row->wall_s;
    absl::FPrintF(stderr, "%8d %8d %9.1f %9.1f %9.3f %9.2f %10.2f %8.2f %8d %9.1f %9.1f\n", n, row->workers, per_s,
                  per_s / n, row->fairness, 1e3 * row->worker_cpu_s / row->steps, 1e3 * row->daemon_cpu_s / row->steps,
                  busy, row->threads, row->created_mb_a_session, row->running_mb_a_session);
    rows.push_back({{"sessions", n},
                    {"workers", row->workers},
                    {"steps_per_s", per_s},
                    {"fairness", row->fairness},
                    {"worker_cpu_ms_per_step", 1e3 * row->worker_cpu_s / row->steps},
                    {"daemon_cpu_ms_per_step", 1e3 * row->daemon_cpu_s / row->steps},
                    {"workers_busy", busy},
                    {"threads", row->threads},
                    {"idle_mb", row->idle_mb},
                    {"created_mb_per_session", row->created_mb_a_session},
                    {"running_mb_per_session", row->running_mb_a_session}});
  }
  return rows;
}

absl::StatusOr<Json> run_viewers(const client::PlanFile& plan, const Options& options) {
  const auto rows = measure_viewers(plan, options.viewers, options.simulated_s, options.rounds);
  if (!rows.ok()) return rows.status();
  Json json = Json::array();
  absl::FPrintF(stderr, "%8s %6s %9s %9s %12s %8s %9s\n", "viewers", "steps", "steps/s", "worker ms", "transport ms",
                "frames", "sent MB");
  for (const ViewersRow& row : *rows) {
    absl::FPrintF(stderr, "%8d %6.0f %9.1f %9.2f %12.2f %8.1f %9.1f\n", row.viewers, row.steps, row.steps / row.wall_s,
                  1e3 * row.worker_cpu_s / row.steps, 1e3 * row.transport_cpu_s / row.steps, row.frames, row.sent_mb);
    json.push_back({{"viewers", row.viewers},
                    {"steps", row.steps},
                    {"steps_per_s", row.steps / row.wall_s},
                    {"worker_cpu_ms_per_step", 1e3 * row.worker_cpu_s / row.steps},
                    {"worker_cpu_over_unwatched", row.worker_cpu_s / rows->front().worker_cpu_s},
                    {"transport_cpu_ms_per_step", 1e3 * row.transport_cpu_s / row.steps},
                    {"frames_per_viewer", row.frames},
                    {"sent_mb", row.sent_mb}});
  }
  return json;
}

Json show(const char* what, const StartupTable& table) {
  absl::FPrintF(stderr, "%s, %d triangles: first frame after %.0f ms\n", what, table.triangles, table.first_frame_ms());
  Json phases = Json::array();
  for (const Phase& phase : table.phases) {
    absl::FPrintF(stderr, "  %-28s %9.1f ms %9.1f ms of computing here\n", phase.name, phase.wall_ms, phase.cpu_ms);
    phases.push_back({{"phase", phase.name}, {"wall_ms", phase.wall_ms}, {"cpu_ms", phase.cpu_ms}});
  }
  return {{"triangles", table.triangles},
          {"first_frame_ms", table.first_frame_ms()},
          {"phases", phases},
          {"content_hash", table.content_hash},
          {"state_hash", table.state_hash}};
}

absl::StatusOr<Json> run_startup(client::PlanFile plan, const Options& options) {
  const lipofill::testing::TemporaryDirectory directory;
  if (options.refinements > 0) {
    const std::filesystem::path file = directory.file("refined." + options.format);
    if (const absl::Status written = write_refined_scan(plan, options.refinements, file); !written.ok()) return written;
    plan.scan_file = file;
  }
  const auto here = measure_startup(plan);
  if (!here.ok()) return here.status();
  Json json = {{"scan", plan.scan_file->filename().string()}, {"in_process", show("in process", *here)}};
  if (options.in_process_only) return json;
  const auto served = measure_served_startup(plan);
  if (!served.ok()) return served.status();
  json["served"] = show("through a daemon", *served);
  return json;
}

int print(const absl::StatusOr<Json>& result) {
  if (result.ok()) {
    std::cout << result->dump(1) << "\n";
    return 0;
  }
  std::cerr << result.status() << "\n";
  return 1;
}

template <typename Run>
void carry_out(const Options& options, const Run& run, int& exit_code) {
  const auto plan = read_plan(options.plan);
  exit_code = print(plan.ok() ? run(*plan, options) : plan.status());
}

int run_main(int argc, char** argv) {
  Options options;
  int exit_code = 0;
  CLI::App app("Measures the service on a daemon of its own. JSON goes to the standard output.");
  app.require_subcommand(1);
  app.add_option("--plan", options.plan.plan, "plan file; default: jaw_angle");
  app.add_option("--scan", options.plan.scan, "scan in place of the plan's");
  app.add_option("--landmarks", options.plan.landmarks, "landmarks in place of the plan's");
  app.add_option("--simulated-s", options.simulated_s, "simulated time of each run")->capture_default_str();

  CLI::App* sessions = app.add_subcommand("sessions", "simulations of one model at once");
  sessions->add_option("--workers", options.workers)->capture_default_str();
  sessions->add_option("--counts", options.sessions)->delimiter(',')->capture_default_str();
  sessions->callback([&] { carry_out(options, run_sessions, exit_code); });
  CLI::App* viewers = app.add_subcommand("viewers", "viewers of one simulation on one worker");
  viewers->add_option("--counts", options.viewers)->delimiter(',')->capture_default_str();
  viewers->add_option("--rounds", options.rounds)->capture_default_str();
  viewers->callback([&] { carry_out(options, run_viewers, exit_code); });
  CLI::App* startup = app.add_subcommand("startup", "from a scan's file to the first frame, by phase");
  startup->add_option("--refinements", options.refinements, "cut every triangle of the scan in four, so often");
  startup->add_option("--format", options.format, "format of the refined scan")
      ->check(CLI::IsMember({"obj", "ply", "stl"}));
  startup->add_flag("--in-process", options.in_process_only, "without a daemon");
  startup->callback([&] { carry_out(options, run_startup, exit_code); });
  CLI11_PARSE(app, argc, argv);
  return exit_code;
}

}  // namespace
}  // namespace lipofill::bench

int main(int argc, char** argv) {
  return lipofill::bench::run_main(argc, argv);
}
