#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "server/backend/backend.h"

namespace lipofill::server {

/// True when a simulation is parked: READY or PAUSED, kept on disk alone. Its summary is in the
/// record then.
bool is_parked(const SimulationRecord& record);

/// The session of a simulation, held; one that was parked is woken for it, which takes as long as
/// building its model does. Null for one that has ended. NOT_FOUND, RESOURCE_EXHAUSTED when there
/// is no room for it now, what no_session_for() says of one that is not back yet. Checked by
/// tests/integration/service/parking_test.cc.
absl::StatusOr<std::shared_ptr<Session>> find_or_wake(Backend& backend, const std::string& id);

/// Why a command finds no session: FAILED_PRECONDITION for a simulation that has ended, UNAVAILABLE
/// for one that is not back yet (reason NOT_BACK_YET; it says what it waits for), or that is still
/// being made (reason BEING_MADE); both are to be tried again.
absl::Status no_session_for(Backend& backend, const char* what, const SimulationRecord& record);

/// Parks simulations that are READY or PAUSED, are not watched, and of which nothing was asked for
/// a time. Looking at their figures does not count.
class ParkingAttendant {
 public:
  /// With `idle` 0 none is ever parked.
  ParkingAttendant(Backend& backend, std::chrono::duration<double> idle);
  ~ParkingAttendant();

 private:
  void look_round();

  Backend& backend_;
  const std::chrono::duration<double> idle_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

}  // namespace lipofill::server
