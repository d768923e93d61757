#include "server/ops/socket_claim.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

absl::Status cannot_serve(const std::string& path, const std::string& why) {
  return absl::FailedPreconditionError(absl::StrCat("cannot listen on unix:", path, ": ", why));
}

/// 0 where somebody takes connections, else the error number of a call that does not wait.
int try_to_connect(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return ENAMETOOLONG;
  std::memcpy(address.sun_path, path.data(), path.size());
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return errno;
  const int error = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
  ::close(probe);
  return error;
}

/// Removes a socket that nobody listens on.
absl::Status clear(const std::string& path) {
  struct stat about {};
  if (::lstat(path.c_str(), &about) != 0) {
    return errno == ENOENT ? absl::OkStatus() : cannot_serve(path, std::strerror(errno));
  }
  if (!S_ISSOCK(about.st_mode)) return cannot_serve(path, "there is something that is no socket; take another path");
  const int error = try_to_connect(path);
  // A full queue of callers is one that somebody made.
  if (error == 0 || error == EAGAIN) {
    return cannot_serve(path, "another program serves there; stop it, or take another path");
  }
  if (error != ECONNREFUSED) return cannot_serve(path, std::strerror(error));
  if (::unlink(path.c_str()) != 0) return cannot_serve(path, std::strerror(errno));
  spdlog::info("{} was left by a daemon that is dead, and is taken over", path);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SocketClaim> SocketClaim::take(const std::string& path) {
  const std::string lock_path = path + ".lock";
  const int lock = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock < 0) {
    return cannot_serve(path, absl::StrCat("cannot open ", lock_path, ": ", std::strerror(errno),
                                           "; may this user make files in its directory?"));
  }
  SocketClaim claim(lock);
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    return cannot_serve(path, "another lipofilld serves there; stop it, or take another path");
  }
  if (absl::Status cleared = clear(path); !cleared.ok()) return cleared;
  return claim;
}

SocketClaim::SocketClaim(SocketClaim&& other) noexcept : lock_(std::exchange(other.lock_, -1)) {}

SocketClaim::~SocketClaim() {
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace lipofill::server
