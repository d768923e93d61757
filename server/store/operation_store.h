#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/operation_records.h"

namespace lipofill::server {

/// The newest operations that are done are kept, so many; an older one goes when one more is done.
inline constexpr int kMaxDoneOperations = 64;

/// Long-running operations and their finished parts. One that is under way is here until it is
/// done, so that the next daemon goes on with it; then it is here with its response and without its
/// parts. Errors as in Store. Checked by tests/unit/server/store/operations_test.cc.
class OperationStore {
 public:
  virtual ~OperationStore() = default;

  /// NOT_FOUND without its patient.
  virtual absl::Status create_operation(const OperationRecord& operation) = 0;
  /// Lists those that are whole, the oldest first.
  virtual absl::StatusOr<std::vector<OperationRecord>> list_operations() = 0;
  /// Keeps a part, in place of one of the same number. NOT_FOUND once the operation is gone or
  /// done.
  virtual absl::Status keep_operation_part(const std::string& id, int number, const std::string& bytes) = 0;
  /// A part that is there and whole, or nothing.
  virtual absl::StatusOr<std::optional<std::string>> get_operation_part(const std::string& id, int number) = 0;
  /// Keeps the response, and lets the parts go. An operation that is gone, with its patient, stays
  /// so.
  virtual absl::Status finish_operation(const std::string& id, const std::string& response_message) = 0;
  /// Forgets an operation that is not done, with its parts.
  virtual absl::Status forget_operation(const std::string& id) = 0;
};

}  // namespace lipofill::server
