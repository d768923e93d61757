#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "server/security/audit_line.h"

namespace lipofill::server {

/// The end of an audit log, from which it goes on.
struct AuditTail {
  AuditHead head;        ///< what the next line is chained to; what is left of a torn line counts
  AuditHead whole;       ///< the last whole line
  bool is_torn = false;  ///< its file ends within a line
};

/// The last line of an audit log: of the file itself or, where that is empty (the daemon ended
/// between two files), of the newest of the files kept beside it. DATA_LOSS when there are lines of
/// which none can be read.
absl::StatusOr<AuditTail> find_audit_tail(const std::string& path);

}  // namespace lipofill::server
