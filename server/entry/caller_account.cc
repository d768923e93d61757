#include "server/entry/caller_account.h"

#include "absl/strings/str_cat.h"
#include "server/sessions/shortage.h"

namespace lipofill::server {
namespace {

constexpr double kRetryDelayS = 1.0;

}  // namespace

absl::Status CallerAccount::take(const std::string& caller, uint64_t bytes) {
  if (bytes == 0) return absl::OkStatus();
  const uint64_t own = bytes_of(caller);
  const bool is_lone = own == 0 && bounds_.lone_may_be_larger;
  const bool is_own_bound = !is_lone && own + bytes > bounds_.bytes_of_caller;
  if (is_own_bound || bytes_ + bytes > bounds_.bytes) {
    const uint64_t would_take = is_own_bound ? own + bytes : bytes_ + bytes;
    const uint64_t most = is_own_bound ? bounds_.bytes_of_caller : bounds_.bytes;
    return shortage("TOO_MANY_BYTES", kRetryDelayS,
                    absl::StrCat(what_, is_own_bound ? " of yours" : " of all callers", " would take ", would_take,
                                 " bytes, may take ", most, "; read the answers before you ask for more"));
  }
  bytes_of_[caller] += bytes;
  bytes_ += bytes;
  return absl::OkStatus();
}

void CallerAccount::give_back(const std::string& caller, uint64_t bytes) {
  if (bytes == 0) return;
  const auto counted = bytes_of_.find(caller);
  counted->second -= bytes;
  if (counted->second == 0) bytes_of_.erase(counted);
  bytes_ -= bytes;
}

uint64_t CallerAccount::bytes_of(const std::string& caller) const {
  const auto counted = bytes_of_.find(caller);
  return counted == bytes_of_.end() ? 0 : counted->second;
}

}  // namespace lipofill::server
