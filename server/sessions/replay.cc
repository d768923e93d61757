#include "server/sessions/replay.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"

namespace lipofill::server {

Replay::Replay(SessionHistory history, uint64_t step)
    : history_(std::move(history)),
      under_way_(!history_.injections.empty() || history_.until_step > step || history_.stop_reason.has_value()) {}

absl::Status Replay::repeat(simulation::Simulation& simulation) {
  const uint64_t step = simulation.report().step;
  auto& injections = history_.injections;
  for (; !injections.empty() && injections.front().step <= step; injections.pop_front()) {
    const absl::Status done = injections.front().step == step
                                  ? simulation.inject(injections.front().spec)
                                  : absl::DataLossError(absl::StrCat("it is of step ", injections.front().step));
    if (done.ok()) continue;
    return absl::Status(done.code(), absl::StrCat("an injection that was acknowledged cannot be repeated at step ",
                                                  step, ": ", std::string(done.message())));
  }
  return absl::OkStatus();
}

uint64_t Replay::last_command_in(uint64_t step) const {
  if (!under_way_) return 0;
  uint64_t last = history_.last_command;
  for (const SessionHistory::Taken& command : history_.commands) {
    if (command.step < step) last = std::max(last, command.number);
  }
  return last;
}

std::optional<uint64_t> Replay::until_step() const {
  return under_way_ ? std::optional(history_.until_step) : std::nullopt;
}

std::string Replay::describe() const {
  if (!under_way_) return history_.note;
  return absl::StrCat("catching up to step ", history_.until_step, " after the daemon was started again",
                      history_.note.empty() ? "" : "; ", history_.note);
}

}  // namespace lipofill::server
