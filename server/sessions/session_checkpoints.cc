// The checkpoints of a session: it keeps its state, goes back to one, and goes on after the daemon
// was started again.

#include <algorithm>
#include <exception>

#include "absl/strings/str_cat.h"
#include "server/sessions/identifiers.h"
#include "server/sessions/session.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

/// Automatic checkpoints are so far apart that they cost less than a hundredth of the run.
constexpr int kLeastSpacing = 100;

}  // namespace

// ---- keeping

absl::StatusOr<CheckpointRecord> Session::keep_checkpoint(CheckpointKind kind, const std::string& id,
                                                          const RequestKey& request) {
  const SessionView view = full_view();
  CheckpointRecord draft;
  draft.simulation = options_.id;
  draft.id = id;
  draft.kind = kind;
  draft.step = view.report.step;
  draft.time_s = view.report.time;
  draft.wall_s = view.wall_s;
  draft.state_hash = view.state_hash;
  draft.create_time_us = now_us();
  const std::vector<SeriesEntry> rows = pending_series(0);
  auto kept = sink_.keep_checkpoint(draft, simulation_->snapshot(), rows, request);
  if (!kept.ok()) return kept;
  forget_pending(rows.size());
  saved_step_ = draft.step;
  return kept;
}

void Session::checkpoint_when_due() {
  if (view_.state != SimulationState::kRunning || catching_up_ || options_.checkpoint_interval_s <= 0.0) return;
  if (Clock::now() >= checkpoint_due_) checkpoint_automatically();
}

void Session::checkpoint_automatically() {
  const Clock::time_point begin = Clock::now();
  const absl::Status kept =
      guarded([this] { return keep_checkpoint(CheckpointKind::kAutomatic, make_id('a'), {}).status(); });
  const auto interval = std::chrono::duration<double>(options_.checkpoint_interval_s);
  const Clock::time_point end = Clock::now();
  checkpoint_due_ =
      end + std::max(std::chrono::duration_cast<Clock::duration>(interval), kLeastSpacing * (end - begin));
  if (kept.ok()) return set_reason(history_.note);
  spdlog::error("simulations/{}: no checkpoint at step {}: {}", options_.id, view_.report.step, kept.ToString());
  set_reason(absl::StrCat(saved_step_ ? absl::StrCat("the last checkpoint is of step ", *saved_step_) : "no checkpoint",
                          ": ", std::string(kept.message())));
}

absl::Status Session::save_now() {
  if (simulation_ == nullptr || catching_up_) return absl::OkStatus();
  const uint64_t step = simulation_->report().step;
  if (step == 0 || saved_step_ == step) return absl::OkStatus();
  return guarded([this] { return keep_checkpoint(CheckpointKind::kAutomatic, make_id('a'), {}).status(); });
}

void Session::save(Done done) {
  post([this, done] { done(save_now()); });
}

Session::Clock::duration Session::idle_time() const {
  const std::lock_guard lock(view_mutex_);
  const bool rests = view_.state == SimulationState::kReady || view_.state == SimulationState::kPaused;
  const bool is_free = watching_ == 0 && !is_held();
  return rests && is_free ? Clock::now() - last_asked_.load() : Clock::duration::zero();
}

/// Counts a holder of a session.
class HeldSession {
 public:
  explicit HeldSession(std::shared_ptr<Session> session) : session_(std::move(session)) { ++session_->holders_; }
  HeldSession(const HeldSession&) = delete;
  HeldSession& operator=(const HeldSession&) = delete;
  ~HeldSession() {
    session_->last_asked_ = Session::Clock::now();
    --session_->holders_;
  }
  Session* get() const { return session_.get(); }

 private:
  const std::shared_ptr<Session> session_;
};

std::shared_ptr<Session> hold(const std::shared_ptr<Session>& session) {
  if (session == nullptr) return nullptr;
  const auto held = std::make_shared<HeldSession>(session);
  return {held, held->get()};
}

bool Session::can_be_parked(Clock::duration idle) const {
  return simulation_ != nullptr && !suspended_ && !catching_up_ && viewers_.empty() && idle_time() >= idle;
}

void Session::park(std::chrono::duration<double> idle) {
  post([this, idle] {
    if (!can_be_parked(std::chrono::duration_cast<Clock::duration>(idle))) return;
    SessionView view;
    const absl::Status parked = guarded([this, &view] {
      const absl::Status saved = save_now();
      if (!saved.ok()) return saved;
      view = full_view();
      return sink_.parked(options_.id, view);
    });
    if (absl::IsAborted(parked)) return;
    if (!parked.ok()) {
      last_asked_ = Clock::now();  // try again after as long
      return spdlog::error("simulations/{} cannot be parked: {}", options_.id, parked.ToString());
    }
    show_figures(std::move(view));
    suspended_ = parked_ = true;
    let_go();
    spdlog::info("simulations/{} is parked at step {}", options_.id, view_.report.step);
  });
}

void Session::suspend(Done done) {
  post([this, done] {
    suspended_ = true;
    for (const Command& waiting : std::exchange(held_, {})) waiting();
    const absl::Status saved = save_now();
    if (!saved.ok()) spdlog::error("simulations/{}: its state is not kept: {}", options_.id, saved.ToString());
    done(saved);
  });
}

// ---- going back

absl::Status Session::go_back(RestoreOrder& order, const RequestKey& request) {
  const CheckpointRecord& checkpoint = order.checkpoint;
  const CommandRecord command{options_.id, 0, CommandKind::kRestore, checkpoint.step, checkpoint.id, now_us()};
  const auto kept = sink_.keep_restore(command, view_.state, order.spec_message, request);
  if (!kept.ok() || !*kept) return kept.status();
  simulation_ = std::move(order.simulation);
  forget_pending(pending_series(0).size());
  saved_step_ = checkpoint.step;
  wall_before_s_ = checkpoint.wall_s;
  clock_runs_ = false;  // begins anew with the next step
  update_view();
  const auto epoch = sink_.begin_epoch(options_.id);
  epoch_ = epoch.ok() ? *epoch : epoch_ + 1;
  note_changed_plan("the simulation went back to a checkpoint after it");
  show_again_from_here();
  spdlog::info("simulations/{} goes on from step {}, checkpoint {}", options_.id, checkpoint.step, checkpoint.id);
  return absl::OkStatus();
}

// ---- catching up

void Session::go_on() {
  post([this] {
    set_reason(catching_up_ ? catching_up_text() : history_.note);
    if (takes_steps() || catching_up_) schedule();
  });
}

std::string Session::catching_up_text() const {
  return absl::StrCat("catching up to step ", history_.until_step, " after the daemon was started again",
                      history_.note.empty() ? "" : "; ", history_.note);
}

/// Repeats what took effect after the step it is at.
void Session::catch_up() {
  const uint64_t step = simulation_->report().step;
  auto& injections = history_.injections;
  for (; !injections.empty() && injections.front().step <= step; injections.pop_front()) {
    const absl::Status done = injections.front().step == step
                                  ? simulation_->inject(injections.front().spec)
                                  : absl::DataLossError(absl::StrCat("it is of step ", injections.front().step));
    if (!done.ok()) {
      return finish(SimulationState::kFailed, absl::StrCat("an injection that was acknowledged cannot be repeated at "
                                                           "step ",
                                                           step, ": ", std::string(done.message())));
    }
  }
  if (!injections.empty() || step < history_.until_step) return;
  if (history_.stop_reason.has_value()) return finish(SimulationState::kStopped, *history_.stop_reason);
  stop_clock();  // real time begins here
  set_reason(history_.note);
  end_catching_up();
}

void Session::end_catching_up() {
  catching_up_ = false;
  for (Command& waiting : std::exchange(held_, {})) queue(std::move(waiting));
}

}  // namespace lipofill::server
