#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/door/descriptor.h"

namespace lipofill::server {

/// A socket that callers connect to.
struct ListeningSocket {
  Descriptor socket;
  std::string unix_path;  ///< empty for TCP
  int port = 0;
};

/// Listens on "host:port", for every address that the host has (port 0: one that is free, the same
/// for all), or on "unix:path". Users of the path's group may write to it; a socket that lies there
/// from before is replaced. UNAVAILABLE when that cannot be, also when another program already
/// does. Checked by tests/unit/server/door/door_test.cc.
absl::StatusOr<std::vector<ListeningSocket>> listen_on(const std::string& host, int port);
absl::StatusOr<std::vector<ListeningSocket>> listen_on_path(const std::string& path);

}  // namespace lipofill::server
