#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace lipofill::server {

/// The right to serve on the path of a UNIX socket, which one daemon has as long as it lives:
/// whoever binds a socket removes what is in its place, and would take the callers of one who still
/// serves. A lock on <path>.lock keeps two daemons apart, also when both start at once; a
/// connection tells of anybody else. What a dead one left is removed. Checked by
/// tests/unit/server/ops/socket_claim_test.cc and tests/integration/service/socket_test.cc.
class SocketClaim {
 public:
  /// FAILED_PRECONDITION where somebody serves there, or where there is something other than a
  /// socket.
  static absl::StatusOr<SocketClaim> take(const std::string& path);
  SocketClaim(SocketClaim&& other) noexcept;
  SocketClaim& operator=(SocketClaim&&) = delete;
  ~SocketClaim();

 private:
  explicit SocketClaim(int lock) : lock_(lock) {}
  int lock_;
};

}  // namespace lipofill::server
