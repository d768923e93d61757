// Libraries start threads of their own before main(), in which no signal is blocked: blocking alone
// would leave those to the default, which is to end the program. So there is a handler; it hands
// the number on through a pipe.

#include "server/ops/signals.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>

namespace lipofill::server {
namespace {

constexpr int kStopSignals[] = {SIGTERM, SIGINT};

int pipe_ends[2] = {-1, -1};

void hand_on(int number) {
  const int error = errno;
  const char byte = static_cast<char>(number);
  [[maybe_unused]] const ssize_t written = ::write(pipe_ends[1], &byte, 1);  // a full pipe has one to read
  errno = error;
}

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : kStopSignals) sigaddset(&signals, number);
  return signals;
}

/// The number of a signal that came within the time, or 0. Without a time, waits for one.
int next_signal(std::optional<std::chrono::microseconds> time) {
  const int timeout_ms = time ? static_cast<int>((time->count() + 999) / 1000) : -1;
  pollfd readable = {pipe_ends[0], POLLIN, 0};
  char byte = 0;
  if (::poll(&readable, 1, timeout_ms) == 1 && ::read(pipe_ends[0], &byte, 1) == 1) return byte;
  return 0;
}

}  // namespace

void take_signals() {
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);  // a file at its limit is an error like a full disk
  [[maybe_unused]] const int made = ::pipe2(pipe_ends, O_CLOEXEC | O_NONBLOCK);
  struct sigaction action {};
  action.sa_handler = hand_on;
  action.sa_flags = SA_RESTART;
  for (const int number : kStopSignals) sigaction(number, &action, nullptr);
  const sigset_t signals = stop_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

int wait_for_signal(std::optional<std::chrono::microseconds> period, const std::function<void()>& tick) {
  const sigset_t signals = stop_signals();
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  while (true) {
    if (period) tick();
    if (const int number = next_signal(period); number > 0) return number;
  }
}

}  // namespace lipofill::server
