#include "server/store/durable_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "absl/strings/str_cat.h"

namespace lipofill::server {
namespace fs = std::filesystem;
namespace {

/// A file descriptor that is closed with it.
class OpenFile {
 public:
  OpenFile(const fs::path& path, int flags) : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int get() const { return descriptor_; }
  bool is_open() const { return descriptor_ >= 0; }

 private:
  int descriptor_;
};

/// Returns 0 or the error number.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    bytes.remove_prefix(static_cast<size_t>(n));
  }
  return 0;
}

absl::Status write_draft(const fs::path& draft, std::string_view bytes) {
  const OpenFile file(draft, O_WRONLY | O_CREAT | O_TRUNC);
  if (!file.is_open()) return file_error("cannot make a file in the data directory", errno);
  if (const int error = write_all(file.get(), bytes); error != 0) return file_error("cannot write a file", error);
  if (::fsync(file.get()) != 0) return file_error("cannot write a file to the medium", errno);
  return absl::OkStatus();
}

/// Makes the directory and its entry in the one above last.
absl::Status make_directory(const fs::path& path) {
  std::error_code error;
  if (!fs::create_directory(path, error)) {
    return error ? file_error("cannot make a directory in the data directory", error.value()) : absl::OkStatus();
  }
  return flush_to_medium(path.parent_path());
}

}  // namespace

bool is_out_of_space(int error_number) {
  return error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
}

absl::Status file_error(const std::string& what, int error_number) {
  const std::string message = absl::StrCat(what, ": ", std::strerror(error_number));
  return is_out_of_space(error_number) ? absl::ResourceExhaustedError(message) : absl::UnavailableError(message);
}

absl::Status flush_to_medium(const fs::path& path) {
  const OpenFile file(path, O_RDONLY);
  if (!file.is_open() || ::fsync(file.get()) != 0) return file_error("cannot write to the medium", errno);
  return absl::OkStatus();
}

fs::path draft_of(const fs::path& path) {
  fs::path draft = path;
  draft += ".draft";
  return draft;
}

absl::Status write_durably(const fs::path& path, std::string_view bytes) {
  if (auto made = make_directory(path.parent_path()); !made.ok()) return made;
  const fs::path draft = draft_of(path);
  absl::Status done = write_draft(draft, bytes);
  if (done.ok() && ::rename(draft.c_str(), path.c_str()) != 0) done = file_error("cannot put a file in place", errno);
  if (!done.ok()) {
    std::error_code ignored;
    fs::remove(draft, ignored);
    return done;
  }
  return flush_to_medium(path.parent_path());
}

absl::StatusOr<std::string> read_whole_file(const fs::path& path, uint64_t max_bytes) {
  const OpenFile file(path, O_RDONLY);
  if (!file.is_open()) {
    if (errno == ENOENT) return absl::NotFoundError(absl::StrCat(path.filename().string(), " is not there"));
    return file_error("cannot open a file", errno);
  }
  struct stat about {};
  if (::fstat(file.get(), &about) != 0) return file_error("cannot read a file", errno);
  const auto size = static_cast<uint64_t>(about.st_size);
  if (size > max_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("a file has ", size, " bytes, the bound is ", max_bytes));
  }
  std::string bytes(size, '\0');
  size_t have = 0;
  while (have < bytes.size()) {
    const ssize_t n = ::read(file.get(), bytes.data() + have, bytes.size() - have);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return file_error("cannot read a file", errno);
    if (n == 0) break;
    have += static_cast<size_t>(n);
  }
  bytes.resize(have);
  return bytes;
}

}  // namespace lipofill::server
