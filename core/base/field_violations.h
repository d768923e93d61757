#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace lipofill {

/// One thing wrong with one field of what a caller gave: the field's path in the wire schema, and a
/// sentence with the value and the bound it breaks.
struct FieldViolation {
  std::string field;
  std::string description;
};

/// Collects everything wrong with an input, so that a caller can mend it all at once.
///
///     FieldViolations violations;
///     violations.check_range("time.step_ms", step_ms, 0.001, 10000, "ms");
///     return violations.to_status();
///
/// Checked by tests/unit/base/base_test.cc.
class FieldViolations {
 public:
  void add(std::string field, std::string description);

  /// Checks that `value` is in [low, high]; not a number breaks every bound.
  void check_range(std::string_view field, double value, double low, double high, std::string_view unit);

  /// Checks that `value` is in [low, high).
  void check_half_open(std::string_view field, double value, double low, double high, std::string_view unit);

  /// Takes over the violations of a status of this kind, their fields below `prefix`; any other
  /// error becomes a violation of `prefix` itself.
  void absorb(std::string_view prefix, const absl::Status& status);

  bool empty() const { return violations_.empty(); }
  const std::vector<FieldViolation>& all() const { return violations_; }

  /// Returns OK when empty, else INVALID_ARGUMENT with every violation in its message and,
  /// structured, in its payload.
  absl::Status to_status() const;

 private:
  std::vector<FieldViolation> violations_;
};

/// A status with a single violation.
absl::Status field_violation(std::string field, std::string description,
                             absl::StatusCode code = absl::StatusCode::kInvalidArgument);

/// The violations a status carries; none for any other status.
std::vector<FieldViolation> field_violations_of(const absl::Status& status);

}  // namespace lipofill
