#pragma once

#include <sys/types.h>

#include <chrono>
#include <string>
#include <vector>

namespace lipofill::testing {

/// A lipofilld of the test's own, on a free port of 127.0.0.1.
class DaemonProcess {
 public:
  /// Starts it, with two workers unless the arguments say otherwise, and waits until it serves;
  /// aborts the test program's current test with a message when it does not.
  DaemonProcess(const std::string& data, const std::vector<std::string>& arguments = {});
  /// Kills it when it still runs.
  ~DaemonProcess();
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  /// Starts one and kills it (SIGKILL) after a while, whether it serves by then or not.
  static void start_and_kill(const std::string& data, const std::vector<std::string>& arguments,
                             std::chrono::milliseconds lifetime);

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  void signal(int number) const;
  /// The exit code, or 128 + the signal that ended it; -1 when it has not ended within the seconds.
  int wait(double timeout_s = 30.0);
  /// SIGTERM, then wait().
  int terminate();
  /// SIGKILL: the daemon dies hard.
  void kill_hard();
  bool running() const { return process_ > 0; }
  pid_t pid() const { return process_; }
  /// What it has logged so far.
  std::string log() const;

 private:
  std::string log_file_;
  pid_t process_ = -1;
  int port_ = 0;
};

/// Runs lipofilld with the arguments until it ends by itself.
int run_daemon_to_end(const std::vector<std::string>& arguments, std::string& output);

}  // namespace lipofill::testing
