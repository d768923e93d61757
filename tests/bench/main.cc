// lipofill_bench: how fast a step is and by which way, everything in one run and in turn, so that
// what else the machine does meets all alike. Exit codes: 0; 1 when a simulation fails or two ways
// to the same answer disagree; 2 for options that cannot be. How long things take is never an
// error.

#include <malloc.h>
#include <omp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>

#include "tests/bench/report.h"

extern "C" void openblas_set_num_threads(int n_threads);

namespace lipofill::bench {
namespace {

/// Scales above this are run after the others, alone in memory.
constexpr int kLargestBeside = 16;
/// And take so many times fewer steps: a step then takes seconds.
constexpr int kStepsBeyond = 3;

struct Options {
  std::vector<int> scales;
  int rounds = 3;
  int steps_a_round = 30;
  int only_plan = 0;
  int only_shape = 0;
  bool steps_only = false;
  bool is_smoke = false;
  std::string out = "bench.json";
};

void say(const std::string& what) {
  std::cerr << "bench: " << what << std::endl;
}

absl::Status measure_memory(const Options& options, Findings& findings) {
  constexpr int kSessions = 4, kSteps = 3;
  say("memory a session");
  auto jaw = make_jaw_angle(options.scales.front());
  if (!jaw.ok()) return jaw.status();
  auto memory = measure_session_memory(*jaw, kSessions, kSteps);
  if (!memory.ok()) return memory.status();
  findings.memory = *memory;
  return absl::OkStatus();
}

absl::Status set_up(const Options& options, Findings& findings) {
  for (const int scale : options.scales) {
    if (scale > kLargestBeside) continue;
    say("setting up " + std::to_string(scale) + "x");
    auto bench = ScaleBench::create(scale, !options.steps_only);
    if (!bench.ok()) return bench.status();
    findings.scales.push_back(*std::move(bench));
    auto equilibrium = EquilibriumBench::create(findings.scales.back()->jaw());
    if (!equilibrium.ok()) return equilibrium.status();
    findings.equilibria.push_back(*std::move(equilibrium));
  }
  const auto attached_jaw = make_attached_jaw_angle(options.scales.front());
  if (!attached_jaw.ok()) return attached_jaw.status();
  auto attached = EquilibriumBench::create(*attached_jaw);
  if (!attached.ok()) return attached.status();
  findings.attached = *std::move(attached);
  return absl::OkStatus();
}

absl::Status run_settled(const JawAngle& jaw, const plan::SimulationSpec& spec, std::vector<SettledRun>& runs) {
  auto run = run_to_settled(jaw, spec);
  if (!run.ok()) return run.status();
  runs.push_back(*std::move(run));
  if (runs.back().state_hash == runs.front().state_hash) return absl::OkStatus();
  return absl::InternalError("the same plan came to two different states");
}

absl::Status run_rounds(const Options& options, Findings& findings) {
  constexpr int kRepeatsOfSmallest = 3;
  for (; findings.rounds < options.rounds; ++findings.rounds) {
    say("round " + std::to_string(findings.rounds + 1) + " of " + std::to_string(options.rounds));
    const JawAngle& jaw = findings.scales.front()->jaw();
    absl::Status settled = run_settled(jaw, jaw.spec, findings.as_planned);
    settled.Update(run_settled(jaw, jaw.settled_shape, findings.settled_shape));
    settled.Update(run_settled(jaw, jaw.settled_in_steps, findings.settled_in_steps));
    for (const auto& equilibrium : findings.equilibria) settled.Update(equilibrium->run_round());
    settled.Update(findings.attached->run_round());
    if (!settled.ok()) return settled;
    for (const auto& scale : findings.scales) {
      const int repeats = scale->scale() <= 1 ? kRepeatsOfSmallest : 1;
      if (const absl::Status status = scale->run_round(options.steps_a_round, repeats); !status.ok()) return status;
      if (const std::string why = scale->disagreement(); !why.empty()) return absl::InternalError(why);
    }
  }
  return absl::OkStatus();
}

absl::Status run_beyond(const Options& options, Findings& findings) {
  for (const int scale : options.scales) {
    if (scale <= kLargestBeside) continue;
    say("steps at " + std::to_string(scale) + "x");
    auto bench = ScaleBench::create(scale, false);
    if (!bench.ok()) return bench.status();
    const int n_steps = std::max(1, options.steps_a_round / kStepsBeyond);
    if (const absl::Status status = (*bench)->run_round(n_steps, 1); !status.ok()) return status;
    findings.beyond.push_back((*bench)->to_json());
  }
  return absl::OkStatus();
}

absl::Status run_only_plan(int times) {
  const auto jaw = make_jaw_angle(1);
  if (!jaw.ok()) return jaw.status();
  std::vector<SettledRun> runs;
  absl::Status status;
  for (int k = 0; k < times && status.ok(); ++k) status = run_settled(*jaw, jaw->spec, runs);
  return status;
}

/// The settled shape alone, found directly, at each scale.
absl::Status run_only_shape(const Options& options) {
  for (const int scale : options.scales) {
    const auto jaw = make_jaw_angle(scale);
    if (!jaw.ok()) return jaw.status();
    const auto bench = EquilibriumBench::create(*jaw);
    if (!bench.ok()) return bench.status();
    for (int k = 0; k < options.only_shape; ++k) {
      if (const absl::Status status = (*bench)->run_round(); !status.ok()) return status;
    }
    std::cout << (*bench)->to_json().dump(1) << "\n";
  }
  return absl::OkStatus();
}

absl::Status run(const Options& options) {
  if (options.only_plan > 0) return run_only_plan(options.only_plan);
  if (options.only_shape > 0) return run_only_shape(options);
  Findings findings;
  for (auto* stage : {+[](const Options&o, Findings&f) { return measure_memory(o, f); },
                      +[](const Options&o, Findings&f) { return set_up(o, f); },
                      +[](const Options&o, Findings&f) { return run_rounds(o, f); },
                      +[](const Options&o, Findings&f) { return run_beyond(o, f); }}) {
    if (const absl::Status status = stage(options, findings); !status.ok()) return status;
  }
  const nlohmann::ordered_json report = make_report(findings);
  print_report(report, std::cout);
  std::ofstream file(options.out);
  file << report.dump(1) << "\n";
  return file.good() ? absl::OkStatus() : absl::InternalError("cannot write " + options.out);
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app("Measures steps of jaw_angle and the ways to solve them; prints tables and writes them as JSON.");
  app.add_option("--scale", options.scales, "sizes beside the plan's own: 4, 16, 64 times it; may be repeated")
      ->check(CLI::IsMember({1, 4, 16, 64}));
  app.add_option("--rounds", options.rounds, "how often everything is done")->check(CLI::Range(1, 100));
  app.add_option("--steps", options.steps_a_round, "steps a round at each scale")->check(CLI::Range(1, 100));
  app.add_flag("--steps-only", options.steps_only, "leave out the other ways to solve a step");
  app.add_option("--only-plan", options.only_plan, "run the plan so often and nothing else, for a profiler")
      ->check(CLI::Range(1, 1000));
  app.add_option("--only-shape", options.only_shape, "find the settled shape in so many rounds and nothing else")
      ->check(CLI::Range(1, 1000));
  app.add_flag("--smoke", options.is_smoke, "one round on a quarter of the plan's size: does it all work");
  app.add_option("--out", options.out, "where the JSON goes");
  CLI11_PARSE(app, argc, argv);
  if (options.is_smoke) {
    options.scales = {kTinyScale};
    options.rounds = 1;
    options.steps_a_round = 2;
  }
  if (options.scales.empty())
    options.scales = options.only_shape > 0 ? std::vector<int>{1} : std::vector<int>{1, 4, 16};
  if (!options.is_smoke) options.scales.push_back(1);
  std::sort(options.scales.begin(), options.scales.end());
  options.scales.erase(std::unique(options.scales.begin(), options.scales.end()), options.scales.end());
  openblas_set_num_threads(1);
  omp_set_max_active_levels(0);
  const absl::Status status = run(options);
  if (status.ok()) return 0;
  std::cerr << "lipofill_bench: " << status.message() << "\n";
  return 1;
}

}  // namespace
}  // namespace lipofill::bench

int main(int argc, char** argv) {
  return lipofill::bench::main_of(argc, argv);
}
