#include "server/sessions/session.h"

#include <algorithm>
#include <exception>
#include <new>

#include "absl/strings/str_cat.h"
#include "server/sessions/memory.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

using simulation::Phase;

constexpr auto kSlice = std::chrono::milliseconds(10);

double seconds(WorkerPool::Clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

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

}  // namespace

Session::Session(SessionOptions options, std::unique_ptr<simulation::Simulation> simulation, WorkerPool& workers,
                 SessionSink& sink)
    : options_(std::move(options)), workers_(workers), sink_(sink), simulation_(std::move(simulation)) {
  view_.n_hexahedra = simulation_->n_hexahedra();
  view_.n_film_cells = simulation_->n_film_cells();
  view_.n_dofs = simulation_->n_dofs();
  if (options_.preview) view_.preview.emplace();
  update_view();
}

// ---- mailbox

void Session::post(Command command) {
  {
    const std::lock_guard lock(mailbox_mutex_);
    mailbox_.push_back(std::move(command));
  }
  carry_out_when_idle();
}

bool Session::mailbox_empty() const {
  const std::lock_guard lock(mailbox_mutex_);
  return mailbox_.empty();
}

// Whoever fails to get the lock may leave: its holder looks at the mailbox again after letting go.
void Session::carry_out_when_idle() {
  while (!mailbox_empty()) {
    const std::unique_lock lock(execution_, std::try_to_lock);
    if (!lock.owns_lock()) return;
    carry_out_commands();
  }
}

void Session::carry_out_commands() {
  while (true) {
    Command next;
    {
      const std::lock_guard lock(mailbox_mutex_);
      if (mailbox_.empty()) return;
      next = std::move(mailbox_.front());
      mailbox_.pop_front();
    }
    next();
  }
}

// Nothing that goes wrong here may cost the caller its answer.
void Session::answer(const Reply& reply, const std::function<absl::Status()>& act) {
  absl::StatusOr<SessionView> result = absl::UnknownError("");
  try {
    const absl::Status done = act();
    if (done.ok()) {
      result = full_view();
    } else {
      result = done;
    }
  } catch (const std::bad_alloc&) {
    result = absl::ResourceExhaustedError(absl::StrCat("simulations/", options_.id, ": out of memory"));
  } catch (const std::exception& error) {
    result = absl::InternalError(absl::StrCat("simulations/", options_.id, ": ", error.what()));
  }
  reply(std::move(result));
}

void Session::command(const char* what, std::initializer_list<SimulationState> allowed, const Reply& reply,
                      const std::function<absl::Status()>& act) {
  if (std::find(allowed.begin(), allowed.end(), view_.state) != allowed.end()) return answer(reply, act);
  reply(absl::FailedPreconditionError(
      absl::StrCat("cannot ", what, ": simulations/", options_.id, " is ", state_name(view_.state))));
}

// ---- commands

void Session::start(Reply reply) {
  post([this, reply] {
    command("start", {SimulationState::kReady}, reply, [this] {
      run();
      return absl::OkStatus();
    });
  });
}

void Session::pause(Reply reply) {
  post([this, reply] {
    command("pause", {SimulationState::kRunning}, reply, [this] {
      leave_running();
      set_state(SimulationState::kPaused, "");
      show_to_viewers(true);
      spdlog::info("simulations/{} paused at step {}", options_.id, view_.report.step);
      return absl::OkStatus();
    });
  });
}

void Session::resume(Reply reply) {
  post([this, reply] {
    command("resume", {SimulationState::kPaused}, reply, [this] {
      run();
      return absl::OkStatus();
    });
  });
}

void Session::stop(std::string reason, Reply reply) {
  post([this, reason, reply] {
    command("stop", {SimulationState::kReady, SimulationState::kRunning, SimulationState::kPaused}, reply,
            [this, &reason] {
              finish(SimulationState::kStopped, reason);
              return absl::OkStatus();
            });
  });
}

void Session::inject(simulation::InjectionSpec injection, Reply reply) {
  post([this, injection, reply] {
    command("inject", {SimulationState::kReady, SimulationState::kRunning, SimulationState::kPaused}, reply,
            [this, &injection] {
              const absl::Status done = simulation_->inject(injection);
              if (done.ok()) {
                note_changed_plan();
                spdlog::info("simulations/{} takes an injection at step {}", options_.id, view_.report.step);
              }
              return done;
            });
  });
}

void Session::inspect(Reply reply) {
  post([this, reply] { answer(reply, [] { return absl::OkStatus(); }); });
}

// ---- running

void Session::run() {
  running_since_ = Clock::now();
  running_since_time_s_ = simulation_->report().time;
  set_state(SimulationState::kRunning, "");
  spdlog::info("simulations/{} runs from step {}", options_.id, view_.report.step);
  if (scheduled_) return;
  scheduled_ = true;
  workers_.schedule(shared_from_this());
}

void Session::leave_running() {
  if (view_.state == SimulationState::kRunning) wall_before_s_ += seconds(Clock::now() - running_since_);
}

WorkerPool::Next Session::take_turn() {
  WorkerPool::Next next;
  {
    const std::lock_guard lock(execution_);
    carry_out_commands();
    next = advance_slice();
    scheduled_ = next.kind != WorkerPool::Next::kNothing;
  }
  carry_out_when_idle();
  return next;
}

WorkerPool::Next Session::advance_slice() {
  const Clock::time_point begin = Clock::now();
  while (view_.state == SimulationState::kRunning) {
    const bool waits = options_.real_time && !preview_is_due() && due_time() > Clock::now();
    if (waits) return {WorkerPool::Next::kLater, due_time()};
    try {
      preview_is_due() ? advance_preview() : advance_one_step();
    } catch (const std::exception& error) {
      finish(SimulationState::kFailed, absl::StrCat("step ", view_.report.step + 1, ": ", error.what()));
    }
    carry_out_commands();
    if (Clock::now() - begin >= kSlice) break;
  }
  if (view_.state != SimulationState::kRunning) return {};
  return {WorkerPool::Next::kAgain, {}};
}

Session::Clock::time_point Session::due_time() const {
  const double ahead_s = simulation_->report().time - running_since_time_s_;
  return running_since_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(ahead_s));
}

void Session::advance_one_step() {
  const Clock::time_point begin = Clock::now();
  simulation_->advance_step();
  const double wall_ms = 1e3 * seconds(Clock::now() - begin);
  const Phase phase = simulation_->phase();
  if (phase != Phase::kFailed) record_step(wall_ms);
  if (phase != Phase::kRunning) return finish(state_of(phase), simulation_->reason());
  show_to_viewers(false);
}

void Session::set_state(SimulationState state, std::string reason) {
  {
    const std::lock_guard lock(view_mutex_);
    view_.state = state;
    view_.reason = std::move(reason);
  }
  if (simulation_ != nullptr) update_view();
}

void Session::finish(SimulationState state, const std::string& reason) {
  leave_running();
  try {
    set_state(state, reason);
    conclude();
  } catch (const std::exception& error) {
    spdlog::error("simulations/{}: its result is lost: {}", options_.id, error.what());
    for (const auto& viewer : viewers_) viewer->close(absl::InternalError("the result of the simulation is lost"));
  }
  viewers_.clear();
  simulation_ = nullptr;
  preview_ = nullptr;
  preview_frame_ = nullptr;
  give_memory_back();
}

void Session::conclude() {
  spdlog::info("simulations/{} is {} after {} steps, {:.3f} s simulated{}{}", options_.id, state_name(view_.state),
               view_.report.step, view_.report.time, view_.reason.empty() ? "" : ": ", view_.reason);
  flush_series();
  judge_preview();
  const SessionView view = full_view();
  {
    const std::lock_guard lock(view_mutex_);
    view_ = view;
  }
  const auto meshes = topology();
  last_frame_ = make_frame({}, true);
  const absl::Status kept = sink_.ended(options_.id, view, *meshes, *last_frame_);
  if (!kept.ok()) spdlog::error("simulations/{}: its result is not in the store: {}", options_.id, kept.ToString());
  for (const auto& viewer : viewers_) viewer->offer(last_frame_);
}

}  // namespace lipofill::server
