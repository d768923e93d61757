#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::server {

/// An address to listen on: a TCP port, or a UNIX socket.
struct ListenAddress {
  std::string host;       ///< empty for a UNIX socket
  int port = 0;           ///< 0: a free one
  std::string unix_path;  ///< empty for TCP

  bool is_unix() const { return !unix_path.empty(); }
  /// True when nothing that comes over the network reaches it: a UNIX socket, 127.0.0.0/8, ::1 or
  /// localhost.
  bool is_local() const;
};

/// Reads "HOST:PORT", "[IPV6]:PORT" or "unix:PATH". INVALID_ARGUMENT saying what is wrong with it.
/// Checked by tests/unit/server/ops/settings_test.cc.
absl::StatusOr<ListenAddress> parse_listen_address(const std::string& text);

}  // namespace lipofill::server
