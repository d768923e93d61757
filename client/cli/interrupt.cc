#include "client/cli/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <ctime>

#include "client/cli/exit_codes.h"

namespace lipofill::client {
namespace {

constexpr long kPollNanoseconds = 100'000'000;

sigset_t interrupting_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

Interrupt::Interrupt() {
  const sigset_t signals = interrupting_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  waiter_ = std::jthread([this, signals](const std::stop_token& done) {
    const timespec poll{0, kPollNanoseconds};
    while (!done.stop_requested()) {
      if (sigtimedwait(&signals, nullptr, &poll) < 0) continue;
      if (source_.stop_requested()) _exit(static_cast<int>(ExitCode::kInterrupted));
      source_.request_stop();
    }
  });
}

void restore_signals_in_child() {
  const sigset_t signals = interrupting_signals();
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

}  // namespace lipofill::client
