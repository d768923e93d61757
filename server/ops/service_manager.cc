#include "server/ops/service_manager.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "absl/strings/numbers.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// WATCHDOG_PID, where it is set, says whom WATCHDOG_USEC is for.
std::optional<std::chrono::microseconds> read_watchdog_period() {
  int64_t allowed_us = 0;
  if (!absl::SimpleAtoi(variable("WATCHDOG_USEC"), &allowed_us) || allowed_us < 2) return std::nullopt;
  const std::string pid = variable("WATCHDOG_PID");
  if (!pid.empty() && pid != std::to_string(::getpid())) return std::nullopt;
  return std::chrono::microseconds(allowed_us / 2);
}

}  // namespace

ServiceManager::ServiceManager() : socket_(variable("NOTIFY_SOCKET")), watchdog_period_(read_watchdog_period()) {}

void ServiceManager::send(const std::string& message) const {
  if (socket_.empty()) return;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_.size() >= sizeof address.sun_path) return spdlog::warn("NOTIFY_SOCKET is too long: {}", socket_);
  std::memcpy(address.sun_path, socket_.data(), socket_.size());
  if (socket_[0] == '@') address.sun_path[0] = '\0';  // a name without a file
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
  const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const ssize_t sent = ::sendto(descriptor, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                                reinterpret_cast<const sockaddr*>(&address), length);
  if (sent < 0) spdlog::warn("the service manager at {} is not told: {}", socket_, std::strerror(errno));
  if (descriptor >= 0) ::close(descriptor);
}

}  // namespace lipofill::server
