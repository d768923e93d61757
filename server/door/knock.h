#pragma once

#include <sys/socket.h>

#include <chrono>

#include "absl/status/status.h"
#include "server/door/listening_socket.h"

namespace lipofill::server {

/// The address at which this process reaches its own socket: loopback where that is every address.
struct OwnAddress {
  sockaddr_storage address{};
  socklen_t size = 0;
};
OwnAddress own_address(const ListeningSocket& socket);

/// Connects, and where `expects_answer` begins to speak HTTP/2 and waits for the first byte of an
/// answer. UNAVAILABLE saying what did not come about within the time, for each step.
absl::Status knock(const OwnAddress& at, bool expects_answer, std::chrono::milliseconds timeout);

}  // namespace lipofill::server
