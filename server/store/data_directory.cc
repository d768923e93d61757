#include "server/store/data_directory.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "server/store/durable_file.h"

namespace lipofill::server {

namespace fs = std::filesystem;
namespace {

constexpr size_t kMostOfName = 64;

absl::Status make_directory(const fs::path& path) {
  std::error_code error;
  if (fs::create_directories(path, error)) ::chmod(path.c_str(), 0700);
  if (!error) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("cannot make ", path.string(), ": ", error.message()));
}

/// Locks a file for as long as its descriptor is open; `in_use` says what to do where another
/// process has it.
absl::StatusOr<int> lock_file(const fs::path& path, int how, const std::string& in_use) {
  const int lock = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock < 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("cannot write in ", path.parent_path().string(), ": ", std::strerror(errno)));
  }
  if (::flock(lock, how | LOCK_NB) == 0) return lock;
  ::close(lock);
  return absl::FailedPreconditionError(in_use);
}

/// The same number of bytes whatever it says.
std::string to_text(const DataDirectory::Member::Beat& beat) {
  return absl::StrFormat("%020d %020d\n", beat.number, beat.beats);
}

}  // namespace

bool is_daemon_name(const std::string& text) {
  const auto fits = [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == ':' || c == '-';
  };
  return !text.empty() && text.size() <= kMostOfName && absl::ascii_isalnum(static_cast<unsigned char>(text[0])) &&
         std::all_of(text.begin(), text.end(), fits);
}

absl::StatusOr<DataDirectory> DataDirectory::open(const fs::path& path) {
  if (absl::Status made = make_directory(path); !made.ok()) return made;
  const auto lock = lock_file(path / "lock", LOCK_EX, absl::StrCat(path.string(), " is in use by another lipofilld"));
  if (!lock.ok()) return lock.status();
  return DataDirectory(path, *lock);
}

// Who opens it alone, as the owner of a file of SQLite does, is kept out.
absl::StatusOr<DataDirectory> DataDirectory::open_shared(const fs::path& path, const std::string& name) {
  if (absl::Status made = make_directory(path); !made.ok()) return made;
  const auto lock = lock_file(path / "lock", LOCK_SH,
                              absl::StrCat(path.string(), " is in use by a lipofilld that does not share it"));
  if (!lock.ok()) return lock.status();
  DataDirectory directory(path, *lock);
  const Member self = directory.member(name);
  if (absl::Status made = make_directory(self.file.parent_path()); !made.ok()) return made;
  const auto name_lock = lock_file(fs::path(self.file).concat(".lock"), LOCK_EX,
                                   absl::StrCat(path.string(), " is in use by another lipofilld of the name ", name,
                                                ": give this one a name of its own by --name"));
  if (!name_lock.ok()) return name_lock.status();
  directory.name_ = name;
  directory.name_lock_ = *name_lock;
  return directory;
}

absl::Status DataDirectory::Member::make(int64_t number) const {
  return write_durably(file, to_text({number, 0}));
}

// It is written over, as whoever reads it must never find it empty, and never made: a directory
// that is not mounted any more has no such file.
absl::Status DataDirectory::Member::write(const Beat& beat) const {
  const std::string text = to_text(beat);
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  const bool is_there = descriptor >= 0 && ::pwrite(descriptor, text.data(), text.size(), 0) >= 0;
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (is_there) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("cannot write ", file.string(),
                                                    " in the directory that this "
                                                    "daemon shares: ",
                                                    std::strerror(error)));
}

DataDirectory::Member::Beat DataDirectory::Member::read() const {
  constexpr uint64_t kMostBytes = 64;
  const auto text = read_whole_file(file, kMostBytes);
  Beat beat;
  if (!text.ok()) return beat;
  const std::vector<std::string> words = absl::StrSplit(*text, absl::ByAnyChar(" \n"), absl::SkipEmpty());
  const bool is_whole =
      words.size() == 2 && absl::SimpleAtoi(words[0], &beat.number) && absl::SimpleAtoi(words[1], &beat.beats);
  return is_whole ? beat : Beat{};
}

DataDirectory::DataDirectory(DataDirectory&& other) noexcept
    : path_(std::move(other.path_)),
      lock_(std::exchange(other.lock_, -1)),
      name_(std::move(other.name_)),
      name_lock_(std::exchange(other.name_lock_, -1)) {}

DataDirectory::~DataDirectory() {
  if (lock_ >= 0) ::close(lock_);
  if (name_lock_ >= 0) ::close(name_lock_);
}

}  // namespace lipofill::server
