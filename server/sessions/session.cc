#include "server/sessions/session.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/sessions/draining.h"
#include "server/sessions/identifiers.h"
#include "server/sessions/session_guard.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

const std::vector<SimulationState> kNotEnded = {SimulationState::kReady, SimulationState::kRunning,
                                                SimulationState::kPaused};

}  // namespace

Session::Session(SessionOptions options, std::unique_ptr<simulation::Simulation> simulation, WorkerPool& workers,
                 SessionSink& sink, SessionHistory history)
    : options_(std::move(options)),
      workers_(workers),
      sink_(sink),
      run_(options_, std::move(simulation), std::move(history), sink) {}

// ---- the way of a command, from the call to the step

void Session::give(SessionCommand command) {
  mailbox_.post([this, command = std::move(command)] { receive(command); });
}

void Session::receive(const SessionCommand& command) {
  idle_.note_use();
  if (run_.is_catching_up() && !run_.is_suspended()) {
    return mailbox_.defer([this, command] { receive(command); });
  }
  answer(command.reply, [&]() -> absl::Status {
    const auto repeated = sink_.was_kept(command.request);
    if (!repeated.ok() || *repeated) return repeated.status();
    const absl::Status fits = check_fits(command);
    return fits.ok() ? command.act() : fits;
  });
}

absl::Status Session::check_fits(const SessionCommand& command) const {
  if (run_.is_parked()) return just_parked();
  if (run_.is_suspended()) return why_suspended_;
  if (command.fits(run_.state())) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("cannot ", command.what, ": simulations/", options_.id, " is ", state_name(run_.state())));
}

CommandRecord Session::record_of(CommandKind kind, const std::string& payload) const {
  return {options_.id, 0, kind, live().simulation()->report().step, payload, now_us()};
}

absl::Status Session::keep_and_do(CommandKind kind, const std::string& payload, const RequestKey& request,
                                  const std::function<void()>& act) {
  const auto kept = sink_.keep_command(record_of(kind, payload), request);
  if (kept.ok() && *kept) act();
  return kept.status();
}

void Session::answer(const Reply& reply, const std::function<absl::Status()>& act) {
  absl::StatusOr<SessionView> result = absl::UnknownError("");
  const absl::Status done = guard_session(options_.id, [&]() -> absl::Status {
    const absl::Status acted = act();
    if (acted.ok()) result = complete(live().measure());
    return acted;
  });
  if (!done.ok()) result = done;
  reply(std::move(result));
}

WorkerPool::Next Session::take_turn() {
  WorkerPool::Next next;
  mailbox_.act([this, &next] {
    next = run_.advance_slice([this] { carry_out_commands(); });
    if (!run_.is_catching_up()) mailbox_.queue_deferred();
    scheduled_ = next.kind != WorkerPool::Next::kNothing;
  });
  return next;
}

void Session::carry_out_commands() {
  if (!run_.is_catching_up()) mailbox_.queue_deferred();
  mailbox_.carry_out();
}

// ---- commands

void Session::start(RequestKey request, Reply reply) {
  const auto act = [this, request] { return keep_and_do(CommandKind::kStart, "", request, [this] { run(); }); };
  give({"start", {SimulationState::kReady}, request, act, std::move(reply)});
}

void Session::pause(RequestKey request, Reply reply) {
  const auto stand_still = [this] {
    run_.pause();
    withdraw();
    // This comes after the answer, which need not wait for it.
    mailbox_.queue([this] {
      if (run_.keeps_its_state()) run_.save().IgnoreError();
    });
  };
  const auto act = [this, request, stand_still] { return keep_and_do(CommandKind::kPause, "", request, stand_still); };
  give({"pause", {SimulationState::kRunning}, request, act, std::move(reply)});
}

void Session::resume(RequestKey request, Reply reply) {
  const auto act = [this, request] { return keep_and_do(CommandKind::kResume, "", request, [this] { run(); }); };
  give({"resume", {SimulationState::kPaused}, request, act, std::move(reply)});
}

void Session::stop(std::string reason, RequestKey request, Reply reply) {
  const auto act = [this, reason, request] {
    return keep_and_do(CommandKind::kStop, reason, request, [this, &reason] {
      withdraw();
      run_.finish(SimulationState::kStopped, reason);
    });
  };
  give({"stop", kNotEnded, request, act, std::move(reply)});
}

void Session::inject(InjectionOrder order, RequestKey request, Reply reply) {
  const auto act = [this, order = std::move(order), request] { return add_injection(order, request); };
  give({"inject", kNotEnded, request, act, std::move(reply)});
}

absl::Status Session::add_injection(const InjectionOrder& order, const RequestKey& request) {
  const auto resolved = resolve(order);
  if (!resolved.ok()) return resolved.status();
  const CommandRecord record = record_of(CommandKind::kInject, order.message);
  const auto kept = sink_.keep_injection(record, *resolved->spec.start, request);
  if (!kept.ok() || !*kept) return kept.status();
  live().inject(*resolved);
  spdlog::info("simulations/{} takes an injection at step {}", options_.id, record.step);
  return absl::OkStatus();
}

absl::StatusOr<simulation::ResolvedInjection> Session::resolve(const InjectionOrder& order) const {
  if (order.check != nullptr) {
    if (absl::Status fits = order.check(); !fits.ok()) return fits;
  }
  return live().simulation()->resolve(order.spec);
}

void Session::foresee(InjectionOrder order, InjectionReply reply) {
  const Finding<plan::InjectionSpec> foreseen(std::move(reply));
  const auto act = [this, answer = foreseen.answer, order = std::move(order)] {
    const auto resolved = resolve(order);
    *answer = resolved.ok() ? absl::StatusOr<plan::InjectionSpec>(resolved->spec) : resolved.status();
    return resolved.status();
  };
  give({"inject", kNotEnded, {}, act, foreseen.reply});
}

void Session::restore(RestoreOrder order, RequestKey request, Reply reply) {
  const auto shared = std::make_shared<RestoreOrder>(std::move(order));  // a command can be copied
  give({"restore", kNotEnded, request, [this, shared, request] { return go_back(*shared, request); }, reply});
}

absl::Status Session::go_back(RestoreOrder& order, const RequestKey& request) {
  const CheckpointRecord& to = order.checkpoint;
  const CommandRecord command{options_.id, 0, CommandKind::kRestore, to.step, to.id, now_us()};
  const auto kept = sink_.keep_restore(command, run_.state(), order.spec_message, request);
  if (kept.ok() && *kept) run_.go_back(to, std::move(order.simulation));
  return kept.status();
}

void Session::checkpoint(std::string checkpoint, RequestKey request, CheckpointReply reply) {
  const Finding<CheckpointRecord> kept(std::move(reply));
  const auto act = [this, answer = kept.answer, checkpoint = std::move(checkpoint), request] {
    *answer = run_.keep_checkpoint(CheckpointKind::kAsked, checkpoint, request);
    return answer->status();
  };
  give({"checkpoint", kNotEnded, {}, act, kept.reply});
}

void Session::inspect(Reply reply) {
  mailbox_.post([this, reply] {
    // A result that could not be kept when it was made: there may be room by now.
    if (has_ended(run_.state()) && !live().result_is_kept()) live().keep_result().IgnoreError();
    answer(reply, [] { return absl::OkStatus(); });
  });
}

void Session::abandon(std::function<absl::Status()> forget, Reply reply) {
  mailbox_.post([this, forget, reply] {
    answer(reply, [this, forget]() -> absl::Status {
      if (const absl::Status forgotten = forget(); !forgotten.ok()) return forgotten;
      withdraw();
      run_.abandon();
      mailbox_.queue_deferred();
      return absl::OkStatus();
    });
  });
}

// ---- turns

void Session::go_on() {
  mailbox_.post([this] {
    run_.go_on();
    if (run_.takes_steps()) schedule();
  });
}

void Session::run() {
  run_.run();
  schedule();
}

void Session::schedule() {
  if (std::exchange(scheduled_, true)) return;
  workers_.schedule(shared_from_this(), options_.tenant);
}

void Session::withdraw() {
  if (workers_.withdraw(*this)) scheduled_ = false;
}

// ---- rest

Session::Clock::duration Session::idle_time() const {
  const SimulationState state = live().figures().state();
  const bool rests = state == SimulationState::kReady || state == SimulationState::kPaused;
  return rests && mailbox_.empty() ? idle_.idle_time() : Clock::duration::zero();
}

std::shared_ptr<Session> hold(const std::shared_ptr<Session>& session) {
  if (session == nullptr) return nullptr;
  session->idle_.hold();
  return std::shared_ptr<Session>(session.get(), [session](Session* held) { held->idle_.let_go(); });
}

bool Session::can_be_parked(Clock::duration idle) const {
  return live().simulation() != nullptr && !run_.is_suspended() && !run_.is_catching_up() && !live().is_watched() &&
         idle_time() >= idle;
}

void Session::park(std::chrono::duration<double> idle) {
  mailbox_.post([this, idle] {
    if (!can_be_parked(std::chrono::duration_cast<Clock::duration>(idle))) return;
    const absl::Status parked = run_.park();
    if (parked.ok() || absl::IsAborted(parked)) return;
    spdlog::error("simulations/{} cannot be parked: {}", options_.id, parked.ToString());
    idle_.note_use();  // try again after as long
  });
}

void Session::suspend(absl::Status why, Done done) {
  mailbox_.post([this, why = std::move(why), done = std::move(done)] {
    why_suspended_ = why;
    run_.suspend();
    mailbox_.carry_out_deferred();
    const absl::Status saved = run_.save();
    if (!saved.ok()) spdlog::error("simulations/{}: its state is not kept: {}", options_.id, saved.ToString());
    done(saved);
  });
}

// ---- figures and viewers

SessionView Session::cached_view() const {
  return complete(live().figures().copy());
}

SessionView Session::complete(SessionView view) const {
  view.viewers = idle_.watchers();
  view.queue_position = workers_.queue_position(*this);
  return view;
}

void Session::watch(std::shared_ptr<Viewer> viewer) {
  idle_.begin_watching();
  mailbox_.post([this, viewer] {
    if (run_.is_parked()) return viewer->close(just_parked());
    if (run_.is_suspended()) return viewer->close(why_suspended_);
    const absl::Status shown = guard_session(options_.id, [&] {
      live().watch(viewer);
      return absl::OkStatus();
    });
    if (!shown.ok()) viewer->close(shown);
  });
}

void Session::unwatch(std::shared_ptr<Viewer> viewer) {
  idle_.end_watching();
  mailbox_.post([this, viewer] { live().unwatch(viewer); });
}

void Session::capture(std::vector<std::string> meshes, CaptureReply reply) {
  mailbox_.post([this, meshes, reply] { live().capture(meshes, reply); });
}

void Session::close_viewers(absl::Status status) {
  mailbox_.post([this, status] { live().close_viewers(status); });
}

}  // namespace lipofill::server
