#include "server/store/space_reserve.h"

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace lipofill::server {
namespace fs = std::filesystem;

SpaceReserve::SpaceReserve(fs::path file, uint64_t bytes) : file_(std::move(file)), bytes_(bytes) {}

bool SpaceReserve::fill() {
  const std::lock_guard lock(mutex_);
  return hold();
}

absl::Status SpaceReserve::spend(const std::function<absl::Status()>& work) {
  absl::Status done = work();
  if (!absl::IsResourceExhausted(done)) return done;
  const std::lock_guard lock(mutex_);
  if (!let_go()) return done;
  done = work();
  hold();
  return done;
}

bool SpaceReserve::let_go() {
  std::error_code error;
  return fs::remove(file_, error);
}

bool SpaceReserve::hold() {
  if (bytes_ == 0) return false;
  std::error_code error;
  if (fs::file_size(file_, error) == bytes_ && !error) return true;
  const int file = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return false;
  // It is the room that counts: a file of zeros with holes would hold none.
  const bool held = ::posix_fallocate(file, 0, static_cast<off_t>(bytes_)) == 0;
  ::close(file);
  if (!held) fs::remove(file_, error);
  return held;
}

}  // namespace lipofill::server
