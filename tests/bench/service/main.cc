// Measures a running daemon: many sessions, many viewers, start-up. Tables go to the error output,
// JSON to the standard output or a file.

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "tests/bench/service/served_plan.h"
#include "tests/bench/service/tables.h"

namespace lipofill::bench {
namespace {

struct Options {
  PlanOptions plan{LIPOFILL_EXAMPLES "/plans/jaw_angle.json", "", ""};
  double simulated_s = 5.0;
  std::string out;
  int workers = 2;
  std::vector<int> sessions = {1, 2, 4, 8};
  std::vector<int> viewers = {0, 1, 50};
  std::vector<std::string> meshes;
  int rounds = 3;
  std::vector<int> refinements = {0};
  std::string format = "obj";
};

absl::StatusOr<Json> run_sessions(const client::PlanFile& plan, const Options& options) {
  std::vector<SessionsRow> rows;
  for (const int sessions : options.sessions) {
    const auto row = measure_sessions(plan, options.workers, sessions, options.simulated_s);
    if (!row.ok()) return row.status();
    rows.push_back(*row);
  }
  return show(rows);
}

absl::StatusOr<Json> run_viewers(const client::PlanFile& plan, const Options& options) {
  const auto rows = measure_viewers(plan, options.viewers, options.meshes, options.simulated_s, options.rounds);
  if (!rows.ok()) return rows.status();
  return show(*rows);
}

absl::StatusOr<Json> run_startup_once(client::PlanFile plan, int refinements, const std::string& format) {
  const lipofill::testing::TemporaryDirectory directory;
  if (refinements > 0) {
    const std::filesystem::path file = directory.file("refined." + format);
    if (const absl::Status written = write_refined_scan(plan, refinements, file); !written.ok()) return written;
    plan.scan_file = file;
  }
  const auto here = measure_startup(plan);
  if (!here.ok()) return here.status();
  const auto served = measure_served_startup(plan);
  if (!served.ok()) return served.status();
  if (served->state_hash != here->state_hash) {
    return absl::DataLossError(absl::StrCat("the first step of the daemon has hash ", served->state_hash,
                                            ", that of this process ", here->state_hash));
  }
  return Json{{"scan", plan.scan_file->filename().string()},
              {"in_process", show("in process", *here)},
              {"served", show("through a daemon", *served)}};
}

absl::StatusOr<Json> run_startup(const client::PlanFile& plan, const Options& options) {
  Json json = Json::array();
  for (const int refinements : options.refinements) {
    const auto once = run_startup_once(plan, refinements, options.format);
    if (!once.ok()) return once.status();
    json.push_back(*once);
  }
  return json;
}

using Run = absl::StatusOr<Json> (*)(const client::PlanFile&, const Options&);

absl::StatusOr<Json> run_all(const std::vector<std::pair<std::string, Run>>& chosen, const Options& options) {
  const auto plan = read_plan(options.plan);
  if (!plan.ok()) return plan.status();
  Json json;
  for (const auto& [name, run] : chosen) {
    const auto result = run(*plan, options);
    if (!result.ok()) return result.status();
    json[name] = *result;
  }
  return json;
}

int finish(const absl::StatusOr<Json>& result, const std::string& out) {
  if (!result.ok()) {
    std::cerr << result.status() << "\n";
    return 1;
  }
  if (out.empty()) {
    std::cout << result->dump(1) << "\n";
    return 0;
  }
  std::ofstream file(out);
  file << result->dump(1) << "\n";
  return file.flush() ? 0 : 1;
}

int run_main(int argc, char** argv) {
  Options options;
  std::vector<std::pair<std::string, Run>> chosen;
  CLI::App app("Measures the service on daemons of its own: name what to measure, one thing or several.");
  app.require_subcommand(1, 3);
  app.add_option("--plan", options.plan.plan, "plan file; default: jaw_angle");
  app.add_option("--scan", options.plan.scan, "scan in place of the plan's");
  app.add_option("--landmarks", options.plan.landmarks, "landmarks in place of the plan's");
  app.add_option("--simulated-s", options.simulated_s, "simulated time of each run")->capture_default_str();
  app.add_option("--out", options.out, "file for the JSON; default: the standard output");

  CLI::App* sessions = app.add_subcommand("sessions", "simulations of one model at once");
  sessions->add_option("--workers", options.workers)->capture_default_str();
  sessions->add_option("--counts", options.sessions)->delimiter(',')->capture_default_str();
  sessions->callback([&] { chosen.emplace_back("sessions", run_sessions); });
  CLI::App* viewers = app.add_subcommand("viewers", "viewers of one simulation on one worker");
  viewers->add_option("--counts", options.viewers)->delimiter(',')->capture_default_str();
  viewers->add_option("--meshes", options.meshes, "default: skin and films")->delimiter(',');
  viewers->add_option("--rounds", options.rounds)->capture_default_str();
  viewers->callback([&] { chosen.emplace_back("viewers", run_viewers); });
  CLI::App* startup = app.add_subcommand("startup", "from a scan's file to the first frame, by phase");
  startup->add_option("--refinements", options.refinements, "cut every triangle of the scan in four, so often")
      ->delimiter(',')
      ->capture_default_str();
  startup->add_option("--format", options.format, "format of the refined scan")
      ->check(CLI::IsMember({"obj", "ply", "stl"}))
      ->capture_default_str();
  startup->callback([&] { chosen.emplace_back("startup", run_startup); });
  CLI11_PARSE(app, argc, argv);
  return finish(run_all(chosen, options), options.out);
}

}  // namespace
}  // namespace lipofill::bench

int main(int argc, char** argv) {
  return lipofill::bench::run_main(argc, argv);
}
