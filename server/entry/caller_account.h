#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "absl/status/status.h"

namespace lipofill::server {

/// The account counts what callers keep in memory, for each and in all, and bounds it. For
/// one thread at a time. Checked by tests/unit/server/entry/caller_account_test.cc.
class CallerAccount {
 public:
  struct Bounds {
    uint64_t bytes = 0;            ///< of all callers
    uint64_t bytes_of_caller = 0;  ///< of one
    /// This tells whether the only thing of a caller may take more than bytes_of_caller.
    bool lone_may_be_larger = false;
  };

  /// @param what  of what the bytes are, as refusals say it: "answers"
  CallerAccount(Bounds bounds, std::string what) : bounds_(bounds), what_(std::move(what)) {}

  /// Counts bytes. RESOURCE_EXHAUSTED naming the bound, and nothing is counted, without room.
  absl::Status take(const std::string& caller, uint64_t bytes);
  /// Gives back what was taken.
  void give_back(const std::string& caller, uint64_t bytes);

  uint64_t bytes() const { return bytes_; }
  uint64_t bytes_of(const std::string& caller) const;

 private:
  const Bounds bounds_;
  const std::string what_;
  std::map<std::string, uint64_t> bytes_of_;  ///< by caller
  uint64_t bytes_ = 0;
};

}  // namespace lipofill::server
