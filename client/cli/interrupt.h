#pragma once

#include <stop_token>
#include <thread>

namespace lipofill::client {

/// Turns the first SIGINT or SIGTERM into a stop request; a second one ends the program at once
/// with 130. Make it before any other thread: the signals are blocked from then on, and threads
/// inherit that.
class Interrupt {
 public:
  Interrupt();

  std::stop_token token() const { return source_.get_token(); }
  bool requested() const { return source_.stop_requested(); }

 private:
  std::stop_source source_;
  std::jthread waiter_;
};

/// Restores in a child, between fork and exec, the signals of a fresh program.
void restore_signals_in_child();

}  // namespace lipofill::client
