#include "client/cli/progress_line.h"

#include <unistd.h>

#include <iostream>

namespace lipofill::client {
namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTerminalPeriod(100);
constexpr std::chrono::seconds kLogPeriod(2);

}  // namespace

ProgressLine::ProgressLine(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressLine::show(const std::string& text) {
  const auto now = steady_clock::now();
  if (quiet_ ||
      now - last_shown_ < (terminal_ ? steady_clock::duration(kTerminalPeriod) : steady_clock::duration(kLogPeriod)))
    return;
  last_shown_ = now;
  if (terminal_) {
    std::cerr << "\r\033[K" << text << std::flush;
    open_ = true;
  } else {
    std::cerr << text << "\n";
  }
}

void ProgressLine::finish(const std::string& text) {
  if (quiet_) return;
  std::cerr << (terminal_ ? "\r\033[K" : "") << text << "\n";
  open_ = false;
  last_shown_ = {};
}

void ProgressLine::finish() {
  if (open_) std::cerr << "\n";
  open_ = false;
}

void ProgressLine::note(const std::string& text) {
  finish(text);
}

}  // namespace lipofill::client
