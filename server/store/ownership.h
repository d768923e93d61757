#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/data_directory.h"
#include "server/store/store.h"
#include "server/store/tenures.h"

namespace lipofill::server {

class PostgresDatabase;

/// A lease lasts so long by the clock of the database (LEASE_IS_LIVE says the same).
inline constexpr std::chrono::seconds kLease{4};
/// Its owner counts on it for that much less, from before it was asked for.
inline constexpr std::chrono::milliseconds kLeaseMargin{500};
inline constexpr std::chrono::seconds kLeaseRenewal{1};

/// One of the daemons that share a database.
struct DaemonRecord {
  int64_t number = 0;  ///< of this start of it
  std::string name;
  std::string address;  ///< where it is called; empty: it does not serve yet
  std::string version;
  int64_t beats = 0;     ///< how often its lease was renewed
  double age_s = 0.0;    ///< since then
  bool is_live = false;  ///< its lease has not ended
};

/// A simulation that has not ended, whose daemon does not live.
struct Orphan {
  std::string simulation;
  std::string daemon;           ///< that had it
  std::optional<double> age_s;  ///< since that one renewed its lease; none where there is no such row
};

/// UNAVAILABLE with the reason OWNED_ELSEWHERE, naming the daemon to ask, or saying that another
/// takes the simulation over.
absl::Status owned_elsewhere(const std::string& simulation, const DaemonRecord& owner);
/// UNAVAILABLE with the reason NO_LEASE, of whoever cannot say who owns what.
absl::Status no_lease();
/// True for what owned_elsewhere() made.
bool is_owned_elsewhere(const absl::Status& status);

/// Which of the daemons that share a database of PostgreSQL owns which simulation.
///
/// A simulation that has not ended belongs to one daemon, in an epoch that no one else had; the
/// store refuses every write of its records to others, in the transaction of that write
/// (OwnerFence). A daemon holds one lease for all that it owns, and renews it every second; once it
/// has ended, others take what it owned. It has a connection of its own, which no long write keeps
/// busy. Thread-safe.
///
/// Checked by tests/unit/server/store/ownership_test.cc and
/// tests/integration/service/fleet_test.cc.
class Ownership {
 public:
  /// Connects to the database at an address of PostgreSQL.
  static absl::StatusOr<std::unique_ptr<Ownership>> open(const std::string& place);
  ~Ownership();

  /// Daemons start one after the other, until end_start(): UNAVAILABLE where another does not come
  /// to an end of it within a minute.
  absl::Status begin_start();
  void end_start();
  /// Takes part, under the name that the directory was opened with, which nobody else has then;
  /// returns the other daemons that live. FAILED_PRECONDITION where one of them has its files in
  /// another directory.
  absl::StatusOr<std::vector<DaemonRecord>> join(const DataDirectory& directory, const std::string& version);
  /// Tells others where this daemon is called.
  absl::Status announce(const std::string& address);
  /// Renews the lease, and returns until when it may be counted on. FAILED_PRECONDITION where the
  /// row of this daemon is another's, or its directory is gone: it is not renewed then.
  absl::StatusOr<LeaseClock::time_point> renew();
  /// Gives back all that it owns, and the lease, for good.
  void leave();
  bool has_left() const { return has_left_; }

  /// Takes a simulation that nobody owns, or one whose lease has ended, or this daemon, in a new
  /// epoch. Otherwise returns what owned_elsewhere() says.
  absl::Status take(const std::string& simulation);
  /// Gives it back if it still is owned in this epoch.
  void give_back(const std::string& simulation, uint64_t epoch);
  /// The daemon that owns a simulation; none where nobody does.
  absl::StatusOr<std::optional<DaemonRecord>> owner_of(const std::string& simulation);
  /// Lists what this daemon owns by the database, with the epochs.
  absl::StatusOr<std::map<std::string, uint64_t>> list_own();
  /// The simulations that have not ended, are not parked, and have no owner that lives.
  absl::StatusOr<std::vector<Orphan>> list_orphans();
  absl::StatusOr<std::vector<DaemonRecord>> list_daemons();

  const std::shared_ptr<Tenures>& tenures() const { return tenures_; }
  const std::string& name() const { return name_; }
  /// True while others count on this daemon for what it owns.
  bool is_held() const { return tenures_->is_held(); }
  std::chrono::duration<double> lease_age() const;
  uint64_t n_takeovers() const { return n_takeovers_; }

 private:
  explicit Ownership(std::unique_ptr<PostgresDatabase> database);
  absl::Status execute(const std::string& sql);
  // These are called with the mutex held.
  absl::StatusOr<std::optional<DaemonRecord>> read_owner(const std::string& simulation);
  absl::StatusOr<std::vector<DaemonRecord>> read_daemons();
  absl::StatusOr<std::vector<DaemonRecord>> check_others(const DataDirectory& directory);
  /// Counts on the lease that was asked for at this time.
  LeaseClock::time_point begin_lease(LeaseClock::time_point asked);
  absl::Status directory_gone() const;
  absl::Status same_name() const;

  std::mutex mutex_;
  const std::unique_ptr<PostgresDatabase> database_;
  std::shared_ptr<Tenures> tenures_;
  std::string name_;
  std::string version_;
  std::string address_;
  DataDirectory::Member member_;
  int64_t beats_ = 0;
  std::atomic<LeaseClock::time_point> renewed_ = LeaseClock::time_point{};
  std::atomic<uint64_t> n_takeovers_ = 0;
  std::atomic<bool> has_left_ = false;
};

/// Gives a simulation that was taken meanwhile back at the end of its scope, unless it is to stay.
class TakenForNow {
 public:
  TakenForNow(const Store& store, std::string simulation);
  ~TakenForNow();
  TakenForNow(const TakenForNow&) = delete;
  TakenForNow& operator=(const TakenForNow&) = delete;
  void keep() { ownership_ = nullptr; }

 private:
  Ownership* ownership_;
  const std::string simulation_;
};

/// Who owns the simulations of a store; null where this daemon alone has its database.
Ownership* ownership_of(const Store& store);

/// Ownership::take() by the daemon of a store; OK where it alone has its database.
absl::Status take_ownership(const Store& store, const std::string& simulation);

}  // namespace lipofill::server
