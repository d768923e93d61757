#include "tests/bench/report.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <thread>

namespace lipofill::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// "model name" and number of processors; nothing that names the machine.
Json describe_machine() {
  std::string processor = "unknown";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    processor = line.substr(line.find(':') + 2);
    break;
  }
  return {{"processor", processor}, {"cores", std::thread::hardware_concurrency()}};
}

double window_mean_ms(const ScaleBench& scale) {
  return scale.steps().samples().find("step")->mean_cpu_ms();
}

double growth_to(const Findings& findings, int scale) {
  for (const auto& bench : findings.scales) {
    if (bench->scale() == scale) return window_mean_ms(*bench) / window_mean_ms(*findings.scales.front());
  }
  return kNotMeasured;
}

/// A frame of every mesh and its encoding, beside the step that it shows.
double frame_share(const ScaleBench& scale) {
  const PhaseSamples& samples = scale.steps().samples();
  return (samples.find("frame")->mean_cpu_ms() + samples.find("encoding")->mean_cpu_ms()) / window_mean_ms(scale);
}

Samples all_injecting(const Findings& findings) {
  Samples all;
  for (const SettledRun& run : findings.as_planned) {
    for (const Span& span : run.injecting.spans()) all.add(span);
  }
  return all;
}

Samples all_runs(const std::vector<SettledRun>& runs) {
  Samples all;
  for (const SettledRun& run : runs) all.add(run.stepping);
  return all;
}

Json bound(const char* name, const char* key, const Json& report, bool at_most, double limit) {
  const Json& figure = report.at(key);
  Json row = {{"name", name}, {"key", key}, {"at_most", at_most}, {"bound", limit}, {"met", nullptr}};
  const bool is_paper_size = report.at("scales").front().at("scale") == 1;
  if (is_paper_size && figure.is_number() && !std::isnan(figure.get<double>())) {
    row["met"] = at_most ? figure.get<double>() <= limit : figure.get<double>() >= limit;
  }
  return row;
}

/// Section 6 of the design.
Json check_bounds(const Json& report) {
  return {
      bound("mean step over the floor", "ratio_to_floor", report, true, 1.5),
      bound("faster than the paper's way", "speedup_vs_paper_way", report, false, 25.0),
      bound("growth of the mean step at 4x", "growth_4x", report, true, 8.0),
      bound("growth of the mean step at 16x", "growth_16x", report, true, 50.0),
      bound("wall seconds to the settled shape", "settle_wall_s", report, true, 2.0),
      bound("the same with the goal SETTLED_SHAPE", "settle_fast_wall_s", report, true, 2.0),
      bound("frame and its encoding, share of a step", "frame_share", report, true, 0.05),
      bound("memory a session [MB]", "session_mb", report, true, 100.0),
      bound("settled shape from rest, in F", "equilibrium_cold_f", report, true, 2.5),
      bound("the same at 16x", "equilibrium_cold_f_16x", report, true, 3.5),
      bound("a shape along a drag, in F", "drag_f", report, true, 0.2),
      bound("a sensitivity, in F", "sensitivity_f", report, true, 0.3),
      bound("a member of an ensemble, in F", "ensemble_member_f", report, true, 0.45),
      bound("the same of 32 side by side", "ensemble_batch_f", report, true, 0.25),
      bound("from rest with neo-Hookean layers and attached edges", "equilibrium_cold_f_attached", report, true, 5.0),
      bound("skin of the settled shape off by [mm]", "equilibrium_error_mm", report, true, 0.003),
      bound("stepping to it over finding it", "fast_over_equilibrium", report, false, 8.0)};
}

void add_settled(const Findings& findings, Json& report) {
  const Samples steps = all_injecting(findings);
  const ScaleBench& base = *findings.scales.front();
  report["step_ms_mean"] = steps.mean_cpu_ms();
  report["step_ms_p99"] = steps.quantile_cpu_ms(0.99);
  report["paper_way_step_ms"] = base.paper_way_ms();
  report["floor_ms"] = base.floor_ms();
  report["ratio_to_floor"] = steps.mean_cpu_ms() / base.floor_ms();
  report["speedup_vs_paper_way"] = base.paper_way_ms() / steps.mean_cpu_ms();
  report["settle_wall_s"] = 1e-3 * all_runs(findings.as_planned).quantile_wall_ms(0.5);
  report["settle_cpu_s"] = 1e-3 * all_runs(findings.as_planned).median_cpu_ms();
  report["settle_fast_wall_s"] = 1e-3 * all_runs(findings.settled_shape).quantile_wall_ms(0.5);
  report["state_hash"] = findings.as_planned.front().state_hash;
  StepCosts costs;
  for (const SettledRun& run : findings.as_planned) costs.add(run.costs);
  report["injecting_steps"] = {{"step", steps.to_json()}, {"parts", costs.to_json()}};
  report["settled"] = {{"as_planned", findings.as_planned.front().to_json()},
                       {"settled_shape", findings.settled_shape.front().to_json()}};
}

const EquilibriumBench* equilibrium_at(const Findings& findings, int scale) {
  for (const auto& bench : findings.equilibria) {
    if (bench->scale() == scale) return bench.get();
  }
  return nullptr;
}

void add_equilibrium(const Findings& findings, Json& report) {
  const Json base = findings.equilibria.front()->to_json();
  for (const char* key : {"cold_f", "error_mm"}) report[std::string("equilibrium_") + key] = base.at(key);
  for (const char* key : {"drag_f", "drag_updates_per_s", "sensitivity_f", "ensemble_member_f", "ensemble_batch_f"}) {
    report[key] = base.at(key);
  }
  const EquilibriumBench* largest = equilibrium_at(findings, 16);
  report["equilibrium_cold_f_16x"] = largest != nullptr ? largest->to_json().at("cold_f") : Json(kNotMeasured);
  report["attached_equilibrium"] = findings.attached->to_json();
  report["equilibrium_cold_f_attached"] = report["attached_equilibrium"].at("cold_f");
  const double unit_ms = base.at("unit_ms");
  report["settled_in_steps_f"] = all_runs(findings.settled_in_steps).median_cpu_ms() / unit_ms;
  report["fast_over_equilibrium"] =
      report["settled_in_steps_f"].get<double>() / report["equilibrium_cold_f"].get<double>();
  report["equilibria"] = Json::array();
  for (const auto& bench : findings.equilibria) report["equilibria"].push_back(bench->to_json());
}

}  // namespace

Json make_report(const Findings& findings) {
  Json report = {{"time_base", "processor time of the working thread; wall time where the name says so"},
                 {"machine", describe_machine()},
                 {"rounds", findings.rounds}};
  add_settled(findings, report);
  add_equilibrium(findings, report);
  report["growth_4x"] = growth_to(findings, 4);
  report["growth_16x"] = growth_to(findings, 16);
  report["frame_share"] = frame_share(*findings.scales.front());
  report["session_mb"] = findings.memory.mb_each;
  report["sessions_for_memory"] = findings.memory.sessions;
  report["scales"] = Json::array();
  for (const auto& scale : findings.scales) report["scales"].push_back(scale->to_json());
  for (const Json& scale : findings.beyond) report["scales"].push_back(scale);
  report["bounds"] = check_bounds(report);
  return report;
}

}  // namespace lipofill::bench
