#include "core/base/field_violations.h"

#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"

namespace lipofill {
namespace {

constexpr char kPayload[] = "lipofill/field_violations";
constexpr char kUnitSeparator = '\x1f';
constexpr char kRecordSeparator = '\x1e';

std::string describe(double value, std::string_view unit, double low, double high, const char* bracket) {
  const std::string with_unit = unit.empty() ? absl::StrCat(value) : absl::StrCat(value, " ", std::string(unit));
  return absl::StrCat("is ", with_unit, ", must be in [", low, ", ", high, bracket);
}

absl::Status to_status_with_code(const std::vector<FieldViolation>& violations, absl::StatusCode code) {
  const auto sentence = [](std::string* out, const FieldViolation& v) {
    absl::StrAppend(out, v.field, ": ", v.description);
  };
  absl::Status status(code, absl::StrJoin(violations, "; ", sentence));
  std::string payload;
  for (const FieldViolation& v : violations) {
    absl::StrAppend(&payload, v.field, std::string(1, kUnitSeparator), v.description, std::string(1, kRecordSeparator));
  }
  status.SetPayload(kPayload, absl::Cord(payload));
  return status;
}

}  // namespace

void FieldViolations::add(std::string field, std::string description) {
  violations_.push_back({std::move(field), std::move(description)});
}

void FieldViolations::check_range(std::string_view field, double value, double low, double high,
                                  std::string_view unit) {
  if (value >= low && value <= high) return;
  add(std::string(field), describe(value, unit, low, high, "]"));
}

void FieldViolations::check_half_open(std::string_view field, double value, double low, double high,
                                      std::string_view unit) {
  if (value >= low && value < high) return;
  add(std::string(field), describe(value, unit, low, high, ")"));
}

void FieldViolations::absorb(std::string_view prefix, const absl::Status& status) {
  if (status.ok()) return;
  const std::vector<FieldViolation> inner = field_violations_of(status);
  if (inner.empty()) add(std::string(prefix), std::string(status.message()));
  for (const FieldViolation& v : inner) {
    const std::string_view separator = prefix.empty() || v.field.empty() ? "" : ".";
    add(absl::StrCat(std::string(prefix), std::string(separator), v.field), v.description);
  }
}

absl::Status FieldViolations::to_status() const {
  if (violations_.empty()) return absl::OkStatus();
  return to_status_with_code(violations_, absl::StatusCode::kInvalidArgument);
}

absl::Status field_violation(std::string field, std::string description, absl::StatusCode code) {
  return to_status_with_code({{std::move(field), std::move(description)}}, code);
}

std::vector<FieldViolation> field_violations_of(const absl::Status& status) {
  std::vector<FieldViolation> violations;
  const auto payload = status.GetPayload(kPayload);
  if (!payload.has_value()) return violations;
  const std::string text(*payload);
  for (const auto record : absl::StrSplit(text, kRecordSeparator, absl::SkipEmpty())) {
    const std::pair<std::string, std::string> parts = absl::StrSplit(record, absl::MaxSplits(kUnitSeparator, 1));
    violations.push_back({parts.first, parts.second});
  }
  return violations;
}

}  // namespace lipofill
