// The commands that clients give a session.

#include <algorithm>
#include <exception>
#include <new>

#include "absl/strings/str_cat.h"
#include "server/sessions/draining.h"
#include "server/sessions/identifiers.h"
#include "server/sessions/session.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

const std::vector<SimulationState> kNotEnded = {SimulationState::kReady, SimulationState::kRunning,
                                                SimulationState::kPaused};

}  // namespace

// Nothing that goes wrong here may cost the caller its answer.
absl::Status Session::guarded(const std::function<absl::Status()>& act) {
  try {
    return act();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat("simulations/", options_.id, ": out of memory"));
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("simulations/", options_.id, ": ", error.what()));
  }
}

void Session::answer(const Reply& reply, const std::function<absl::Status()>& act) {
  absl::StatusOr<SessionView> result = absl::UnknownError("");
  const absl::Status done = guarded([&]() -> absl::Status {
    const absl::Status acted = act();
    if (acted.ok()) result = full_view();
    return acted;
  });
  if (!done.ok()) result = done;
  reply(std::move(result));
}

void Session::command(const char* what, std::vector<SimulationState> allowed, const RequestKey& request,
                      const Reply& reply, const std::function<absl::Status()>& act) {
  last_asked_ = Clock::now();
  if (catching_up_ && !suspended_) {
    held_.push_back([this, what, allowed, request, reply, act] { command(what, allowed, request, reply, act); });
    return;
  }
  answer(reply, [&]() -> absl::Status {
    const auto repeated = sink_.was_kept(request);
    if (!repeated.ok() || *repeated) return repeated.status();
    const absl::Status fits = check_allowed(what, allowed);
    return fits.ok() ? act() : fits;
  });
}

absl::Status Session::check_allowed(const char* what, const std::vector<SimulationState>& allowed) const {
  if (parked_) return just_parked();
  if (suspended_) return draining();
  if (std::find(allowed.begin(), allowed.end(), view_.state) != allowed.end()) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("cannot ", what, ": simulations/", options_.id, " is ", state_name(view_.state)));
}

CommandRecord Session::record_of(CommandKind kind, const std::string& payload) const {
  return {options_.id, 0, kind, simulation_->report().step, payload, now_us()};
}

absl::Status Session::keep_and_do(CommandKind kind, const std::string& payload, const RequestKey& request,
                                  const std::function<void()>& act) {
  const auto kept = sink_.keep_command(record_of(kind, payload), request);
  if (kept.ok() && *kept) act();
  return kept.status();
}

void Session::start(RequestKey request, Reply reply) {
  post([this, request, reply] {
    command("start", {SimulationState::kReady}, request, reply,
            [this, request] { return keep_and_do(CommandKind::kStart, "", request, [this] { run(); }); });
  });
}

void Session::pause(RequestKey request, Reply reply) {
  post([this, request, reply] {
    command("pause", {SimulationState::kRunning}, request, reply, [this, request] {
      return keep_and_do(CommandKind::kPause, "", request, [this] {
        leave_running();
        set_state(SimulationState::kPaused, "");
        show_to_viewers(true);
        spdlog::info("simulations/{} paused at step {}", options_.id, view_.report.step);
        // This comes after the answer, which need not wait for it.
        queue([this] {
          if (options_.checkpoint_interval_s > 0.0) save_now().IgnoreError();
        });
      });
    });
  });
}

void Session::resume(RequestKey request, Reply reply) {
  post([this, request, reply] {
    command("resume", {SimulationState::kPaused}, request, reply,
            [this, request] { return keep_and_do(CommandKind::kResume, "", request, [this] { run(); }); });
  });
}

void Session::stop(std::string reason, RequestKey request, Reply reply) {
  post([this, reason, request, reply] {
    command("stop", kNotEnded, request, reply, [this, reason, request] {
      return keep_and_do(CommandKind::kStop, reason, request,
                         [this, &reason] { finish(SimulationState::kStopped, reason); });
    });
  });
}

void Session::inject(InjectionOrder order, RequestKey request, Reply reply) {
  post([this, order, request, reply] {
    command("inject", kNotEnded, request, reply, [this, order, request]() -> absl::Status {
      const auto resolved = resolve(order);
      if (!resolved.ok()) return resolved.status();
      const auto kept = sink_.keep_injection(record_of(CommandKind::kInject, order.message), *resolved->start, request);
      if (!kept.ok() || !*kept) return kept.status();
      const absl::Status done = simulation_->inject(*resolved);
      if (done.ok()) note_changed_plan("an injection was added after it");
      spdlog::info("simulations/{} takes an injection at step {}", options_.id, view_.report.step);
      return done;
    });
  });
}

absl::StatusOr<plan::InjectionSpec> Session::resolve(const InjectionOrder& order) const {
  if (order.check != nullptr) {
    if (absl::Status fits = order.check(); !fits.ok()) return fits;
  }
  return simulation_->resolve(order.spec);
}

void Session::foresee(InjectionOrder order, InjectionReply reply) {
  post([this, order, reply] {
    const auto foreseen = std::make_shared<absl::StatusOr<plan::InjectionSpec>>(absl::UnknownError(""));
    const auto pass_on = [foreseen, reply](const absl::StatusOr<SessionView>& view) {
      reply(view.ok() ? std::move(*foreseen) : view.status());
    };
    command("inject", kNotEnded, {}, pass_on, [this, foreseen, order] {
      *foreseen = resolve(order);
      return foreseen->status();
    });
  });
}

void Session::restore(RestoreOrder order, RequestKey request, Reply reply) {
  const auto shared = std::make_shared<RestoreOrder>(std::move(order));  // a command can be copied
  post([this, shared, request, reply] {
    command("restore", kNotEnded, request, reply, [this, shared, request] { return go_back(*shared, request); });
  });
}

void Session::inspect(Reply reply) {
  post([this, reply] {
    // A result that could not be kept when it was made: there may be room by now.
    if (has_ended(view_.state) && !result_kept_) keep_result().IgnoreError();
    answer(reply, [] { return absl::OkStatus(); });
  });
}

void Session::abandon(std::function<absl::Status()> forget, Reply reply) {
  post([this, forget, reply] {
    answer(reply, [this, forget]() -> absl::Status {
      if (const absl::Status forgotten = forget(); !forgotten.ok()) return forgotten;
      result_kept_ = true;  // there is to be none
      if (simulation_ == nullptr) return absl::OkStatus();
      leave_running();
      set_state(SimulationState::kStopped, "deleted");
      topology();
      last_frame_ = make_frame({}, true);
      for (const auto& viewer : viewers_) viewer->offer(last_frame_);
      let_go();
      return absl::OkStatus();
    });
  });
}

void Session::checkpoint(std::string checkpoint, RequestKey request, CheckpointReply reply) {
  post([this, checkpoint, request, reply] {
    // This goes through command(), so that it waits until the session has caught up; its view is
    // not wanted.
    const auto kept = std::make_shared<absl::StatusOr<CheckpointRecord>>(absl::UnknownError(""));
    const auto pass_on = [kept, reply](const absl::StatusOr<SessionView>& view) {
      reply(view.ok() ? std::move(*kept) : view.status());
    };
    command("checkpoint", kNotEnded, {}, pass_on, [this, kept, checkpoint, request] {
      *kept = keep_checkpoint(CheckpointKind::kAsked, checkpoint, request);
      return kept->status();
    });
  });
}

}  // namespace lipofill::server
