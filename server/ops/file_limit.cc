#include "server/ops/file_limit.h"

#include <sys/resource.h>

#include <algorithm>

namespace lipofill::server {
namespace {

/// More would only make the kernel's tables large.
constexpr rlim_t kEnough = 1 << 20;
constexpr size_t kFilesOfOthers = 256;
constexpr size_t kFilesOfConnection = 3;
constexpr size_t kLeastConnections = 16;

}  // namespace

size_t raise_file_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < kEnough) {
    limit.rlim_cur = std::min(limit.rlim_max, kEnough);
    ::setrlimit(RLIMIT_NOFILE, &limit);
  }
  return file_limit();
}

size_t file_limit() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_NOFILE, &limit) == 0 ? static_cast<size_t>(limit.rlim_cur) : 0;
}

size_t connections_within(size_t files) {
  const size_t for_connections = files > kFilesOfOthers ? files - kFilesOfOthers : 0;
  return std::max(kLeastConnections, for_connections / kFilesOfConnection);
}

}  // namespace lipofill::server
