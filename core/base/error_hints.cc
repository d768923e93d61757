#include "core/base/error_hints.h"

#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace lipofill {
namespace {

constexpr char kPayload[] = "lipofill/error_hints";

}  // namespace

absl::Status with_hints(absl::Status status, const ErrorHints& hints) {
  const std::string delay = hints.retry_delay_s ? absl::StrCat(*hints.retry_delay_s) : "";
  status.SetPayload(kPayload, absl::Cord(absl::StrCat(hints.reason, " ", delay)));
  return status;
}

std::optional<ErrorHints> hints_of(const absl::Status& status) {
  const auto payload = status.GetPayload(kPayload);
  if (!payload.has_value()) return std::nullopt;
  const std::pair<std::string, std::string> parts = absl::StrSplit(std::string(*payload), absl::MaxSplits(' ', 1));
  ErrorHints hints{parts.first, std::nullopt};
  if (double delay = 0.0; absl::SimpleAtod(parts.second, &delay)) hints.retry_delay_s = delay;
  return hints;
}

}  // namespace lipofill
