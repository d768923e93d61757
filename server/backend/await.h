#pragma once

#include <future>
#include <memory>
#include <utility>

namespace lipofill::server {

/// Asks for something whose answer comes on another thread, and waits for it. For threads that may
/// wait: those of the pool for long calls.
///
///     const auto view = await<absl::StatusOr<SessionView>>([&](auto reply) { session.start({}, reply); });
template <typename Answer, typename Ask>
Answer await(Ask&& ask) {
  auto promise = std::make_shared<std::promise<Answer>>();
  ask([promise](Answer answer) { promise->set_value(std::move(answer)); });
  return promise->get_future().get();
}

}  // namespace lipofill::server
