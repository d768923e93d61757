#include "server/security/small_file.h"

#include <sys/stat.h>

#include <fstream>

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace {

constexpr size_t kMostBytes = size_t{1} << 20;

}  // namespace

absl::StatusOr<std::string> read_small_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMostBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  const auto size = static_cast<size_t>(file.gcount());
  if (!file.is_open() || (file.bad() || size == 0)) {
    return absl::InvalidArgumentError(absl::StrCat("\"", path, "\" cannot be read, or is empty"));
  }
  if (size > kMostBytes) {
    return absl::InvalidArgumentError(absl::StrCat("\"", path, "\" has more than ", kMostBytes, " bytes"));
  }
  text.resize(size);
  return text;
}

FileStamp stamp_of(const std::string& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return {};
  return {static_cast<uint64_t>(found.st_ino), static_cast<uint64_t>(found.st_size),
          static_cast<int64_t>(found.st_mtim.tv_sec), static_cast<int64_t>(found.st_mtim.tv_nsec)};
}

}  // namespace lipofill::server
