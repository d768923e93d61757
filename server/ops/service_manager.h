#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace lipofill::server {

/// Reports to the service manager that started the daemon, by systemd's protocol: datagrams to the
/// UNIX socket NOTIFY_SOCKET, and a sign of life within every WATCHDOG_USEC. Without the variables
/// nothing is sent. Checked by tests/unit/server/ops/service_manager_test.cc and
/// tests/integration/service/drain_test.cc.
class ServiceManager {
 public:
  /// Reads the environment.
  ServiceManager();

  void tell_ready(const std::string& status) const { send("READY=1\nSTATUS=" + status); }
  void tell_stopping() const { send("STOPPING=1\nSTATUS=draining"); }
  void tell_alive() const { send("WATCHDOG=1"); }

  /// Period of calls of tell_alive(): half of what is allowed; none without a watchdog.
  std::optional<std::chrono::microseconds> watchdog_period() const { return watchdog_period_; }

 private:
  void send(const std::string& message) const;

  std::string socket_;
  std::optional<std::chrono::microseconds> watchdog_period_;
};

}  // namespace lipofill::server
