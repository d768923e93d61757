#pragma once

#include <sys/socket.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "server/door/descriptor.h"

namespace lipofill::server {

/// The address that a connection is counted by; empty for loopback and UNIX sockets, behind which
/// many callers may be.
std::string counted_address(const sockaddr_storage& peer);

/// Small writes go at once; a peer whose machine acknowledges nothing for `unread` is lost.
void set_up_peer_socket(int socket, std::chrono::milliseconds unread);

/// A pair of sockets between the door and gRPC. gRPC tells the name of the door's end as its peer:
/// "unix-abstract:lipofill-{kind}-{process}-{id}".
struct InnerPair {
  Descriptor ours;
  Descriptor grpcs;
};
/// Nothing when there is no descriptor left, or no name for it.
std::optional<InnerPair> make_inner_pair(const std::string& kind, uint64_t id);

}  // namespace lipofill::server
