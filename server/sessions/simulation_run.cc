#include "server/sessions/simulation_run.h"

#include <exception>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/sessions/identifiers.h"
#include "server/sessions/memory_reserve.h"
#include "server/sessions/session_guard.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

using simulation::Phase;

constexpr auto kSlice = std::chrono::milliseconds(10);

SimulationState state_of(Phase phase) {
  switch (phase) {
    case Phase::kRunning:
      return SimulationState::kRunning;
    case Phase::kSettled:
      return SimulationState::kSettled;
    case Phase::kFinished:
      return SimulationState::kFinished;
    case Phase::kFailed:
      return SimulationState::kFailed;
  }
  return SimulationState::kFailed;
}

std::optional<uint64_t> step_kept(uint64_t step) {
  return step > 0 ? std::optional(step) : std::nullopt;  // the start can be had from the plan
}

}  // namespace

SimulationRun::SimulationRun(const SessionOptions& options, std::unique_ptr<simulation::Simulation> simulation,
                             SessionHistory history, SessionSink& sink)
    : id_(options.id),
      real_time_(options.real_time),
      live_(options, std::move(simulation), history.state, history.wall_s, sink),
      replay_(std::move(history), live_.figures().latest().report.step),
      checkpoints_(options.checkpoint_interval_s, step_kept(live_.figures().latest().report.step)) {
  live_.set_catching_up(replay_.until_step());
}

// ---- steps

bool SimulationRun::takes_steps() const {
  const bool has_some = replay_.under_way() || state() == SimulationState::kRunning;
  return has_some && !suspended_ && live_.simulation() != nullptr;
}

WorkerPool::Next SimulationRun::advance_slice(const std::function<void()>& carry_out_commands) {
  const Clock::time_point begin = Clock::now();
  while (takes_steps()) {
    if (replay_.under_way()) catch_up();
    if (!takes_steps()) break;
    // Time in the queue is no time spent running, and real time begins with the first step.
    const double time_s = live_.simulation()->report().time;
    if (!live_.clock().runs()) live_.clock().begin(time_s);
    const bool previews = live_.preview_is_due() && !replay_.under_way();
    const bool keeps_pace = real_time_ && !previews && !replay_.under_way();
    const Clock::time_point due = live_.clock().due_time(time_s);
    if (keeps_pace && due > Clock::now()) return {WorkerPool::Next::kLater, due};
    advance(previews);
    carry_out_commands();
    checkpoint_when_due();
    if (Clock::now() - begin >= kSlice) break;
  }
  if (!takes_steps()) return {};
  return {WorkerPool::Next::kAgain, {}};
}

void SimulationRun::advance(bool previews) {
  try {
    const MayFail may_fail;
    if (previews) return live_.advance_preview();
    live_.advance_step();
    const simulation::Simulation& simulation = *live_.simulation();
    const bool goes_on = simulation.phase() == Phase::kSettled && replay_.goes_on_after(simulation.report().step);
    if (simulation.phase() != Phase::kRunning && !goes_on) finish(state_of(simulation.phase()), simulation.reason());
  } catch (const std::bad_alloc&) {
    fail_step("the daemon ran out of memory; run the plan again when others have ended");
  } catch (const std::exception& error) {
    fail_step(error.what());
  }
}

void SimulationRun::fail_step(const std::string& why) {
  const uint64_t step = live_.figures().latest().report.step;
  finish(SimulationState::kFailed, absl::StrCat("step ", step + 1, ": ", why));
}

/// Repeats what took effect after the step it is at.
void SimulationRun::catch_up() {
  const absl::Status repeated = replay_.repeat(*live_.simulation());
  if (!repeated.ok()) return finish(SimulationState::kFailed, std::string(repeated.message()));
  if (!replay_.has_caught_up(live_.simulation()->report().step)) return;
  if (replay_.stop_reason()) return finish(SimulationState::kStopped, *replay_.stop_reason());
  live_.clock().stop();  // real time begins here
  replay_.end();
  live_.set_catching_up(std::nullopt);
  live_.set_reason(replay_.note());
}

// ---- states

void SimulationRun::go_on() {
  live_.set_reason(replay_.describe());
  if (!takes_steps()) return;
  if (replay_.was_there()) {
    checkpoints_.begin_soon();
  } else {
    checkpoints_.begin();
  }
}

void SimulationRun::run() {
  live_.set_state(SimulationState::kRunning, "");
  checkpoints_.begin();
  spdlog::info("simulations/{} runs from step {}", id_, live_.figures().latest().report.step);
}

void SimulationRun::pause() {
  live_.clock().stop();
  live_.set_state(SimulationState::kPaused, "");
  live_.show_at_rest();
  spdlog::info("simulations/{} paused at step {}", id_, live_.figures().latest().report.step);
}

void SimulationRun::finish(SimulationState state, std::string reason) {
  live_.clock().stop();
  try {
    const MayFail may_fail;
    live_.set_state(state, std::move(reason));
    const SessionView& view = live_.figures().latest();
    spdlog::info("simulations/{} is {} after {} steps, {:.3f} s simulated{}{}", id_, state_name(state),
                 view.report.step, view.report.time, view.reason.empty() ? "" : ": ", view.reason);
    live_.conclude();
  } catch (const std::exception& error) {
    spdlog::error("simulations/{}: its result is lost: {}", id_, error.what());
    live_.close_viewers(absl::InternalError("the result of the simulation is lost"));
  }
  let_go();
}

void SimulationRun::abandon() {
  live_.forget_result();
  if (live_.simulation() == nullptr) return;
  live_.clock().stop();
  live_.set_state(SimulationState::kStopped, "deleted");
  live_.conclude_unkept();
  let_go();
}

absl::Status SimulationRun::park() {
  const absl::Status parked = guard_session(id_, [this] {
    const absl::Status saved = save();
    return saved.ok() ? live_.keep_parked() : saved;
  });
  if (!parked.ok()) return parked;
  suspended_ = parked_ = true;
  spdlog::info("simulations/{} is parked at step {}", id_, live_.figures().latest().report.step);
  let_go();
  return parked;
}

/// Releases the simulation; nothing is left to repeat.
void SimulationRun::let_go() {
  live_.let_go();
  replay_.end();
  live_.set_catching_up(std::nullopt);
}

// ---- checkpoints

void SimulationRun::go_back(const CheckpointRecord& checkpoint, std::unique_ptr<simulation::Simulation> simulation) {
  checkpoints_.note_kept(checkpoint.step);
  live_.go_back(std::move(simulation), checkpoint.wall_s);
  spdlog::info("simulations/{} goes on from step {}, checkpoint {}", id_, checkpoint.step, checkpoint.id);
}

absl::StatusOr<CheckpointRecord> SimulationRun::keep_checkpoint(CheckpointKind kind, const std::string& id,
                                                                const RequestKey& request) {
  auto kept = live_.keep_checkpoint(kind, id, replay_.last_command_in(live_.simulation()->report().step), request);
  if (kept.ok()) checkpoints_.note_kept(live_.simulation()->report().step);
  return kept;
}

absl::Status SimulationRun::keep_automatically() {
  return guard_session(id_, [this] { return keep_checkpoint(CheckpointKind::kAutomatic, make_id('a'), {}).status(); });
}

absl::Status SimulationRun::save() {
  if (live_.simulation() == nullptr) return absl::OkStatus();
  const uint64_t step = live_.simulation()->report().step;
  if (step == 0 || checkpoints_.kept_step() == step) return absl::OkStatus();
  return keep_automatically();
}

void SimulationRun::checkpoint_when_due() {
  const bool moves = state() == SimulationState::kRunning || replay_.under_way();
  if (!moves || !checkpoints_.is_due()) return;
  const Clock::time_point began = Clock::now();
  const absl::Status kept = keep_automatically();
  checkpoints_.begin_next(began);
  if (kept.ok()) return live_.set_reason(replay_.describe());
  const SessionView& view = live_.figures().latest();
  spdlog::error("simulations/{}: no checkpoint at step {}: {}", id_, view.report.step, kept.ToString());
  const auto last = checkpoints_.kept_step();
  live_.set_reason(absl::StrCat(last ? absl::StrCat("the last checkpoint is of step ", *last) : "no checkpoint", ": ",
                                std::string(kept.message())));
}

}  // namespace lipofill::server
