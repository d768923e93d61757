#include "server/security/audit_log.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/security/audit_tail.h"
#include "server/store/durable_file.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

absl::Status cannot(const char* what, const std::string& path) {
  const bool is_full = is_out_of_space(errno);
  const std::string message = absl::StrCat("cannot ", what, " ", path, ": ", std::strerror(errno));
  return is_full ? absl::ResourceExhaustedError(message) : absl::FailedPreconditionError(message);
}

absl::Status sync_folder_of(const std::string& path) {
  const std::string folder = std::filesystem::absolute(path).parent_path();
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return cannot("open", folder);
  const absl::Status synced = ::fsync(descriptor) == 0 ? absl::OkStatus() : cannot("flush", folder);
  ::close(descriptor);
  return synced;
}

}  // namespace

/// A file held by this process alone.
class AuditLog::File {
 public:
  static absl::StatusOr<std::shared_ptr<File>> open(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
    if (descriptor < 0) return cannot("write", path);
    auto file = std::make_shared<File>(descriptor, path);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) return cannot("be the only one to write", path);
    struct stat found {};
    if (::fstat(descriptor, &found) != 0) return cannot("look at", path);
    file->size = static_cast<uint64_t>(found.st_size);
    if (auto synced = sync_folder_of(path); !synced.ok()) return synced;
    return file;
  }

  File(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}
  ~File() { ::close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  /// The number of bytes that were written, fewer than asked for when the medium is full.
  size_t write(const std::string& bytes) {
    size_t written = 0;
    while (written < bytes.size()) {
      const ssize_t n = ::write(descriptor_, bytes.data() + written, bytes.size() - written);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) break;
      written += static_cast<size_t>(n);
    }
    size += written;
    return written;
  }
  /// A pipe or a device has no medium to wait for (EINVAL).
  absl::Status flush() const {
    return ::fdatasync(descriptor_) == 0 || errno == EINVAL ? absl::OkStatus() : cannot("flush", path_);
  }

  uint64_t size = 0;

 private:
  const int descriptor_;
  const std::string path_;
};

absl::StatusOr<std::unique_ptr<AuditLog>> AuditLog::open(const std::string& path, uint64_t rotate_bytes,
                                                         std::shared_ptr<const AnchorKey> key) {
  std::unique_ptr<AuditLog> log(new AuditLog(path, rotate_bytes));
  auto file = File::open(path);
  if (!file.ok()) return file.status();
  log->file_ = *std::move(file);
  const auto tail = find_audit_tail(path);
  if (!tail.ok()) return tail.status();
  log->head_ = tail->head;
  log->is_torn_ = tail->is_torn;
  // What a former run wrote and did not flush is, before it is anchored.
  if (auto flushed = log->file_->flush(); !flushed.ok()) return flushed;
  auto anchor = AuditAnchor::open(path, tail->whole, std::move(key));
  if (!anchor.ok()) return anchor.status();
  log->anchor_ = *std::move(anchor);
  spdlog::info("the audit log {} goes on after line {}, hash {}", path, log->head_.number, log->head_.hash);
  return log;
}

AuditLog::~AuditLog() {
  if (anchor_ == nullptr) return;  // it was not opened
  absl::Status kept = file_->flush();
  if (kept.ok()) kept = anchor_->note(head_);
  if (!kept.ok()) spdlog::error("{}", std::string(kept.message()));
  spdlog::info("the audit log {} ends with line {}, hash {}", path_, head_.number, head_.hash);
}

absl::Status AuditLog::append(const AuditEntry& entry) {
  return write(entry).status();
}

absl::Status AuditLog::append_durably(const AuditEntry& entry) {
  const auto written = write(entry);
  if (!written.ok()) return written.status();
  if (auto flushed = written->file->flush(); !flushed.ok()) return flushed;
  return anchor_->note(written->head);
}

AuditHead AuditLog::head() const {
  const std::lock_guard lock(mutex_);
  return head_;
}

absl::StatusOr<AuditLog::Written> AuditLog::write(const AuditEntry& entry) {
  const std::lock_guard lock(mutex_);
  if (file_->size >= rotate_bytes_) {
    if (auto rotated = rotate(); !rotated.ok()) return rotated;
  }
  const std::string line = make_audit_line(entry, head_);
  const std::string before = is_torn_ ? "\n" : "";
  const size_t written = file_->write(absl::StrCat(before, line, "\n"));
  if (written == before.size() + line.size() + 1) {
    head_ = {head_.number + 1, hash_of_line(line)};
    is_torn_ = false;
    return Written{file_, head_};
  }
  // The part that was written stays, and the next line follows it.
  const absl::Status error = cannot("write", path_);
  if (written > before.size()) {
    head_.hash = hash_of_line(line.substr(0, written - before.size()));
    is_torn_ = true;
  } else if (written > 0) {
    is_torn_ = false;
  }
  return error;
}

absl::Status AuditLog::rotate() {
  if (auto flushed = file_->flush(); !flushed.ok()) return flushed;
  if (auto noted = anchor_->note(head_); !noted.ok()) return noted;
  const std::string kept = absl::StrCat(path_, absl::StrFormat(".%012d", head_.number));
  const bool is_kept = ::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, kept.c_str(), RENAME_NOREPLACE) == 0;
  // The file is missing if it was renamed before and there was no room for a new one then.
  if (!is_kept && errno != ENOENT) return cannot("rename to keep", kept);
  auto file = File::open(path_);
  if (!file.ok()) return file.status();
  file_ = *std::move(file);
  is_torn_ = false;
  spdlog::info("the audit log goes on in a new file after {}, line {}, hash {}", kept, head_.number, head_.hash);
  return absl::OkStatus();
}

}  // namespace lipofill::server
