#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lipofill::server {

/// The content of one line of the audit log, written before or after a call.
struct AuditEntry {
  std::string subject;
  std::string tenant;
  std::string role;
  std::string method;
  std::vector<std::string> resources;  ///< names in its request: pseudonymous ids
  std::string made;                    ///< the name of what it made
  std::string outcome;                 ///< "BEGUN", or its status code
  std::string request_id;
};

/// The end of a chain of lines: the next line carries on from it.
struct AuditHead {
  uint64_t number = 0;                      ///< the last line had it
  std::string hash = std::string(64, '0');  ///< the last line had it
};

/// SHA-256 of a line without its end, in hex.
std::string hash_of_line(std::string_view line);

/// The line that follows `head`: a JSON object with "number", "time", the entry, and "previous",
/// the hash of the line before.
std::string make_audit_line(const AuditEntry& entry, const AuditHead& head);

/// Number and "previous" of a line; false for one that is none, as a loss of power may leave.
bool read_audit_line(std::string_view line, AuditHead& told);

}  // namespace lipofill::server
