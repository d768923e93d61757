#include "tests/bench/whole_steps.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/wire/frame_encoding.h"

namespace lipofill::bench {
namespace {

using simulation::Phase;
using simulation::Simulation;

constexpr double kWarmUpEnd = 0.75;   // s, in the midst of filling the first zone
constexpr double kWarmUpStep = 0.05;  // s

absl::Status check_running(const Simulation& simulation) {
  if (simulation.phase() == Phase::kRunning) return absl::OkStatus();
  return absl::InternalError(absl::StrCat("a simulation ended: ", simulation.reason()));
}

}  // namespace

absl::StatusOr<std::unique_ptr<WholeSteps>> WholeSteps::create(const JawAngle& jaw) {
  plan::SimulationSpec large_steps = jaw.spec;
  large_steps.step = kWarmUpStep;
  auto warm_up = Simulation::create(jaw.model, large_steps);
  if (!warm_up.ok()) return warm_up.status();
  while ((*warm_up)->report().time < kWarmUpEnd) {
    if (const absl::Status status = check_running(**warm_up); !status.ok()) return status;
    (*warm_up)->advance_step();
  }
  const std::string snapshot = (*warm_up)->snapshot();
  warm_up->reset();
  auto simulation = Simulation::create(jaw.model, jaw.spec);
  if (!simulation.ok()) return simulation.status();
  if (const absl::Status status = (*simulation)->restore(snapshot); !status.ok()) return status;
  (*simulation)->advance_step();  // it is as long as those before it
  return std::unique_ptr<WholeSteps>(new WholeSteps(*std::move(simulation)));
}

absl::Status WholeSteps::advance(int n_steps) {
  for (int k = 0; k < n_steps; ++k) {
    Stopwatch watch;
    simulation_->advance_step();
    samples_.add("step", watch.lap());
    if (const absl::Status status = check_running(*simulation_); !status.ok()) return status;
    costs_.add(simulation_->report().cost);
    take_frame({"skin", "film/" + simulation_->spec().films[0].name}, "");
    take_frame({}, "_of_all_meshes");
  }
  return absl::OkStatus();
}

/// A frame of some meshes, all when empty, and its encoding, for one viewer or for fifty: they
/// share it.
void WholeSteps::take_frame(const std::vector<std::string>& meshes, const std::string& suffix) {
  Stopwatch watch;
  server::Frame frame;
  frame.fields = simulation_->frame(meshes);
  samples_.add("frame" + suffix, watch.lap());
  std::vector<std::string> names;
  for (const simulation::FrameField& field : frame.fields) names.push_back(field.mesh);
  const server::EncodedMessages encoded = server::encode_frame(server::to_whole_frame(frame, {names}));
  samples_.add("encoding" + suffix, watch.lap());
  size_t& bytes = frame_bytes_["frame" + suffix];
  bytes = 0;
  for (const std::string& message : encoded.messages) bytes += message.size();
}

nlohmann::ordered_json WholeSteps::to_json() const {
  return {{"phases", samples_.to_json()},
          {"parts", costs_.to_json()},
          {"frame_bytes", frame_bytes_},
          {"from_simulated_s", kWarmUpEnd},
          {"state_hash", simulation_->state_hash()}};
}

absl::StatusOr<SettledRun> run_to_settled(const JawAngle& jaw, const plan::SimulationSpec& spec) {
  SettledRun run;
  Stopwatch watch;
  auto created = Simulation::create(jaw.model, spec);
  if (!created.ok()) return created.status();
  Simulation& simulation = **created;
  run.creation = watch.lap();
  while (simulation.phase() == Phase::kRunning) {
    simulation.advance_step();
    const Span step = watch.lap();
    run.stepping = run.stepping + step;
    if (simulation.report().step_size <= spec.step) {
      run.injecting.add(step);
      run.costs.add(simulation.report().cost);
    }
    ++run.steps;
  }
  if (simulation.phase() != Phase::kSettled) {
    return absl::InternalError(absl::StrCat("a simulation did not settle: ", simulation.reason()));
  }
  run.simulated_s = simulation.report().time;
  run.skin_max_displacement_mm = 1e3 * simulation.report().skin_max_displacement;
  run.skin_volume_change_ml = 1e6 * simulation.report().skin_volume_change;
  run.state_hash = simulation.state_hash();
  return run;
}

nlohmann::ordered_json SettledRun::to_json() const {
  return {{"wall_s", stepping.wall_s},
          {"cpu_s", stepping.cpu_s},
          {"creation_wall_s", creation.wall_s},
          {"steps", steps},
          {"simulated_s", simulated_s},
          {"skin_max_displacement_mm", skin_max_displacement_mm},
          {"skin_volume_change_ml", skin_volume_change_ml},
          {"state_hash", state_hash}};
}

}  // namespace lipofill::bench
