#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "server/backend/backend.h"
#include "server/store/ownership.h"

namespace lipofill::server {

/// Renews this daemon's lease, and makes what it has in memory what it owns by the database, where
/// several daemons share one. Twice a second it looks: what another has taken meanwhile is let go
/// of, what has no owner that lives is taken and brought back from its last checkpoint. Without a
/// lease, which ends here before it ends for others, every simulation is let go of, and those that
/// nobody took come back with the lease.
///
/// Looking is all that it relies on: it is told of nothing.
/// Checked by tests/integration/service/fleet_test.cc.
class FleetAttendant {
 public:
  FleetAttendant(Backend& backend, Ownership& ownership);
  ~FleetAttendant();

 private:
  class Departures;

  void look_round();
  void renew();
  void tell(const absl::Status& status);
  void stand_still();
  void compare();
  void give_up(const std::string& id, uint64_t epoch);
  void bring_back_own(const std::string& id, uint64_t epoch);
  void take_over();
  bool is_full();
  void note_arrivals();
  void add_metrics();

  Backend& backend_;
  Ownership& ownership_;
  const std::shared_ptr<Departures> departures_;
  LeaseClock::time_point renewal_;  ///< the last one that was tried
  std::string told_;                ///< why the lease is not renewed, as the log has it
  /// These are held here, and the database did not say so at the last look; with their epochs.
  std::map<std::string, uint64_t> doubtful_;
  /// These were taken over and are on their way; with when their daemon was last heard of.
  std::map<std::string, LeaseClock::time_point> arrivals_;
  std::atomic<double> last_takeover_s_ = 0.0;
  bool was_full_ = false;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace lipofill::server
