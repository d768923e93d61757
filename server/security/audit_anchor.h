#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "server/security/anchor_key.h"
#include "server/security/audit_line.h"

namespace lipofill::server {

/// The anchor of an audit log: a file "{log}.anchor" beside it that has the number and the hash of
/// its last durable line, signed where there is a key. A log that ends before it was cut off. The
/// file has two slots of 1 KiB, written in turn, so that a loss of power leaves one of them
/// whole; an anchor is never ahead of what is on the medium. Thread-safe. Checked by
/// tests/unit/server/security/audit_anchor_test.cc.
class AuditAnchor {
 public:
  static std::string path_of(const std::string& log) { return log + ".anchor"; }

  /// Opens the anchor of a log whose last whole line is `head`, or makes one. `key` may be nullptr.
  /// DATA_LOSS when the log has fewer lines than the anchor, another last line, or the anchor is
  /// not signed with the key; FAILED_PRECONDITION when it cannot be written.
  static absl::StatusOr<std::unique_ptr<AuditAnchor>> open(const std::string& log, const AuditHead& head,
                                                           std::shared_ptr<const AnchorKey> key);
  ~AuditAnchor();
  AuditAnchor(const AuditAnchor&) = delete;
  AuditAnchor& operator=(const AuditAnchor&) = delete;

  /// Notes a line that is on the medium. One that is older than what is noted changes nothing.
  absl::Status note(const AuditHead& head);

 private:
  AuditAnchor(int descriptor, std::string path, std::shared_ptr<const AnchorKey> key)
      : descriptor_(descriptor), path_(std::move(path)), key_(std::move(key)) {}

  const int descriptor_;
  const std::string path_;
  const std::shared_ptr<const AnchorKey> key_;
  std::mutex mutex_;
  uint64_t number_ = 0;
  int slot_ = 0;
};

/// Reads what the anchor's file says; nothing where there is no file. DATA_LOSS when neither of its
/// slots can be read or, where a key is given, is signed with it.
absl::StatusOr<std::optional<AuditHead>> read_anchor(const std::string& path, const AnchorKey* key);

}  // namespace lipofill::server
