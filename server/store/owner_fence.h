#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "server/store/database.h"
#include "server/store/tenures.h"

namespace lipofill::server {

class Ownership;

/// Tells whether a simulation that no daemon owns may be written.
enum class Unowned { kIsRefused, kMayBeWritten };

/// Keeps daemons from the records of simulations that another one owns. All but the first are
/// called in a transaction that changes something, and do nothing for a daemon that has its
/// database alone. Checked by tests/unit/server/store/ownership_test.cc.
class OwnerFence {
 public:
  explicit OwnerFence(Database& database) : database_(database) {}

  /// Puts the fence up, for a daemon that has joined others. `ownership` outlives this.
  void raise(Ownership& ownership);
  Ownership* ownership() const { return ownership_; }

  /// Returns OK while this daemon owns the simulation, which nobody takes then before the end of
  /// the transaction; else what owned_elsewhere() says.
  absl::Status check(const std::string& simulation, Unowned unowned = Unowned::kIsRefused);
  /// Makes this daemon the owner of a simulation that is made.
  absl::Status write_owner(const std::string& simulation);
  absl::Status erase_owner(const std::string& simulation);
  /// Is called once the transaction that erased the owner is done.
  void forget(const std::string& simulation);

 private:
  absl::Status refuse(const std::string& simulation, int64_t daemon);

  Database& database_;
  Ownership* ownership_ = nullptr;
  std::shared_ptr<Tenures> tenures_;
};

}  // namespace lipofill::server
