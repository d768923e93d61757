#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/security/audit_anchor.h"
#include "server/security/audit_line.h"

namespace lipofill::server {

/// Records who did what to which pseudonymous id, and how it ended: a JSON object a line, each with
/// the hash of the line before, so that a line that was changed, taken out or put in is found
/// (verify_audit). A file beside it, its anchor, has the last durable line: a log that was cut off
/// before that is noticed at the next start (AuditAnchor). Lines are only ever added (O_APPEND). A
/// file that has grown to its size is renamed to "{file}.{number of its last line}" and stays:
/// nothing is ever deleted, that is for whoever archives it. Thread-safe. Checked by
/// tests/unit/server/security/audit_log_test.cc and tests/integration/security/audit_test.cc.
class AuditLog {
 public:
  /// Goes on after the last line there is, also one that a loss of power cut short.
  /// FAILED_PRECONDITION when the file cannot be written, or another daemon writes it; DATA_LOSS
  /// when its end was cut off. `key` signs the anchor; nullptr: nothing does.
  static absl::StatusOr<std::unique_ptr<AuditLog>> open(const std::string& path, uint64_t rotate_bytes,
                                                        std::shared_ptr<const AnchorKey> key = nullptr);
  ~AuditLog();
  AuditLog(const AuditLog&) = delete;
  AuditLog& operator=(const AuditLog&) = delete;

  /// Appends an entry, which is on the medium some time later: at the next durable line or the end
  /// of the file.
  absl::Status append(const AuditEntry& entry);
  /// Appends an entry, which is on the medium when it returns.
  absl::Status append_durably(const AuditEntry& entry);

  AuditHead head() const;

 private:
  class File;
  AuditLog(std::string path, uint64_t rotate_bytes) : path_(std::move(path)), rotate_bytes_(rotate_bytes) {}
  /// A line that was written, and the file that has it.
  struct Written {
    std::shared_ptr<File> file;
    AuditHead head;
  };
  absl::StatusOr<Written> write(const AuditEntry& entry);
  absl::Status rotate();

  const std::string path_;
  const uint64_t rotate_bytes_;
  mutable std::mutex mutex_;
  std::shared_ptr<File> file_;
  std::unique_ptr<AuditAnchor> anchor_;
  AuditHead head_;
  bool is_torn_ = false;  ///< the file ends within a line
};

/// Findings from the files of an audit log.
struct AuditSummary {
  uint64_t lines = 0;
  uint64_t torn_lines = 0;  ///< cut short by a loss of power, and yet those that were written
  AuditHead before;         ///< what the first line carries on from
  AuditHead head;
};

/// Looks through files of an audit log, given in their order: every line must carry on from the one
/// before. DATA_LOSS naming the first that does not, or when no line is one of an audit log;
/// INVALID_ARGUMENT for a file that cannot be read. That lines are missing at the end shows only
/// against a head that was kept elsewhere: the daemon logs it when it starts, at each new file and
/// when it stops. Where an anchor is given, the line that it has must be there: DATA_LOSS for a log
/// that ends before it or has another in its place.
absl::StatusOr<AuditSummary> verify_audit(const std::vector<std::string>& files,
                                          const std::optional<AuditHead>& anchor = std::nullopt);

}  // namespace lipofill::server
