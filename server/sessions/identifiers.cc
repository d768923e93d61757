#include "server/sessions/identifiers.h"

#include <chrono>
#include <random>

#include "absl/strings/str_format.h"

namespace lipofill::server {

std::string make_id(char prefix) {
  std::random_device entropy;
  return absl::StrFormat("%c%08x%08x", prefix, entropy(), entropy());
}

int64_t now_us() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(since_epoch).count();
}

}  // namespace lipofill::server
