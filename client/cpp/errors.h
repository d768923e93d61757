#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace google::rpc {
class Status;
}

namespace lipofill::client {

/// One thing wrong with one field of a request: its path in the wire schema, and a sentence with
/// the value and the bound.
struct FieldViolation {
  std::string field;
  std::string description;
};

/// Details of an error beyond its message: google.rpc.ErrorInfo and google.rpc.BadRequest.
struct ErrorDetails {
  std::string reason;
  std::map<std::string, std::string> metadata;
  std::vector<FieldViolation> violations;
};

/// A wire status as a status of this library, its details in a payload; OK stays OK.
/// Checked by tests/unit/client/errors_test.cc.
absl::Status status_of(const google::rpc::Status& wire);

/// Makes INVALID_ARGUMENT with violations found on this side of the wire, in the same form as the
/// daemon's.
absl::Status invalid_fields(std::string_view message, const std::vector<FieldViolation>& violations);

/// The details a status carries; empty for a status without any.
ErrorDetails error_details_of(const absl::Status& status);

/// The error as people read it: the violations, a line each, if there are any; otherwise the
/// message.
std::string error_text(const absl::Status& status);

/// The error as programs read it: {"error": {"code", "message", "reason", "field_violations":
/// [{"field", "description"}]}}.
std::string error_json(const absl::Status& status);

}  // namespace lipofill::client
