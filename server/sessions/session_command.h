#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "server/sessions/session_sink.h"

namespace lipofill::server {

using SessionReply = std::function<void(absl::StatusOr<SessionView>)>;

/// A command is what a client asks of a session.
struct SessionCommand {
  const char* what;                      ///< as refusals name it
  std::vector<SimulationState> allowed;  ///< where it fits
  RequestKey request;
  std::function<absl::Status()> act;  ///< has the sink keep it, then lets it take effect
  SessionReply reply;

  bool fits(SimulationState state) const { return std::find(allowed.begin(), allowed.end(), state) != allowed.end(); }
};

/// A place for what a command finds out, and the reply that passes it on in place of the figures.
template <typename Answer>
struct Finding {
  explicit Finding(std::function<void(absl::StatusOr<Answer>)> to)
      : answer(std::make_shared<absl::StatusOr<Answer>>(absl::UnknownError(""))),
        reply([answer = answer, to = std::move(to)](const absl::StatusOr<SessionView>& view) {
          to(view.ok() ? std::move(*answer) : view.status());
        }) {}

  std::shared_ptr<absl::StatusOr<Answer>> answer;
  SessionReply reply;
};

}  // namespace lipofill::server
