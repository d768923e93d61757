#include "server/sessions/session.h"

#include <exception>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
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
                 SessionSink& sink, SessionHistory history)
    : options_(std::move(options)),
      workers_(workers),
      sink_(sink),
      simulation_(std::move(simulation)),
      epoch_(options_.epoch),
      history_(std::move(history)),
      wall_before_s_(history_.wall_s) {
  const uint64_t step = simulation_->report().step;
  catching_up_ = !history_.injections.empty() || history_.until_step > step || history_.stop_reason.has_value();
  if (step > 0) saved_step_ = step;
  view_.state = history_.state;
  view_.n_hexahedra = simulation_->n_hexahedra();
  view_.n_film_cells = simulation_->n_film_cells();
  view_.n_dofs = simulation_->n_dofs();
  if (options_.preview) view_.preview.emplace();
  update_view();
}

// ---- mailbox

void Session::post(Command command) {
  queue(std::move(command));
  carry_out_when_idle();
}

void Session::queue(Command command) {
  const std::lock_guard lock(mailbox_mutex_);
  mailbox_.push_back(std::move(command));
}

bool Session::mailbox_empty() const {
  const std::lock_guard lock(mailbox_mutex_);
  return mailbox_.empty();
}

// Carries out commands if it gets the lock. Whoever fails to get it may leave: its holder looks at
// the mailbox again after letting go.
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

// ---- running

void Session::run() {
  set_state(SimulationState::kRunning, "");
  spdlog::info("simulations/{} runs from step {}", options_.id, view_.report.step);
  schedule();
}

void Session::schedule() {
  if (checkpoint_due_ == Clock::time_point()) {
    checkpoint_due_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                         std::chrono::duration<double>(options_.checkpoint_interval_s));
  }
  if (scheduled_) return;
  scheduled_ = true;
  workers_.schedule(shared_from_this(), options_.tenant);
}

// Time in the queue is no time spent running, and real time begins with the first step.
void Session::begin_clock() {
  clock_runs_ = true;
  running_since_ = Clock::now();
  running_since_time_s_ = simulation_->report().time;
}

void Session::stop_clock() {
  if (std::exchange(clock_runs_, false)) wall_before_s_ += seconds(Clock::now() - running_since_);
}

void Session::leave_running() {
  stop_clock();
  if (workers_.withdraw(*this)) scheduled_ = false;
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

/// True when there is a step to take, now or when its time comes.
bool Session::takes_steps() const {
  return simulation_ != nullptr && !suspended_ && (catching_up_ || view_.state == SimulationState::kRunning);
}

WorkerPool::Next Session::advance_slice() {
  const Clock::time_point begin = Clock::now();
  while (takes_steps()) {
    if (catching_up_) catch_up();
    if (!takes_steps()) break;
    if (!clock_runs_) begin_clock();
    const bool previews = preview_is_due() && !catching_up_;
    const bool waits = options_.real_time && !previews && !catching_up_ && due_time() > Clock::now();
    if (waits) return {WorkerPool::Next::kLater, due_time()};
    try {
      previews ? advance_preview() : advance_one_step();
    } catch (const std::exception& error) {
      finish(SimulationState::kFailed, absl::StrCat("step ", view_.report.step + 1, ": ", error.what()));
    }
    carry_out_commands();
    checkpoint_when_due();
    if (Clock::now() - begin >= kSlice) break;
  }
  if (!takes_steps()) return {};
  return {WorkerPool::Next::kAgain, {}};
}

Session::Clock::time_point Session::due_time() const {
  const double ahead_s = simulation_->report().time - running_since_time_s_;
  return running_since_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(ahead_s));
}

void Session::advance_one_step() {
  const Clock::time_point begin = Clock::now();
  simulation_->advance_step();
  const double wall_ms = kMillisecondsPerSecond * seconds(Clock::now() - begin);
  const Phase phase = simulation_->phase();
  if (phase != Phase::kFailed) record_step(wall_ms);
  if (phase != Phase::kRunning) return finish(state_of(phase), simulation_->reason());
  show_to_viewers(false);
}

void Session::set_reason(std::string reason) {
  const std::lock_guard lock(view_mutex_);
  view_.reason = std::move(reason);
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
  let_go();
}

/// Releases everything that only a simulation that has not ended needs.
void Session::let_go() {
  viewers_.clear();
  simulation_ = nullptr;
  preview_ = nullptr;
  preview_frame_ = nullptr;
  end_catching_up();
  give_memory_back();
}

void Session::conclude() {
  spdlog::info("simulations/{} is {} after {} steps, {:.3f} s simulated{}{}", options_.id, state_name(view_.state),
               view_.report.step, view_.report.time, view_.reason.empty() ? "" : ": ", view_.reason);
  judge_preview();
  show_figures(full_view());
  topology();
  last_frame_ = make_frame({}, true);
  if (const absl::Status kept = keep_result(); !kept.ok()) {
    spdlog::error("simulations/{}: its result is not in the store: {}", options_.id, kept.ToString());
  }
  for (const auto& viewer : viewers_) viewer->offer(last_frame_);
}

absl::Status Session::keep_result() {
  if (last_frame_ == nullptr) return absl::DataLossError("there is none");
  absl::Status kept = flush_series();
  if (kept.ok()) kept = sink_.ended(options_.id, cached_view(), *topology_, *last_frame_);
  result_kept_ = kept.ok();
  return kept;
}

}  // namespace lipofill::server
