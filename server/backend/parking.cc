#include "server/backend/parking.h"

#include <algorithm>

#include "server/backend/simulation_recovery.h"
#include "server/sessions/thread_name.h"

namespace lipofill::server {
namespace {

using Seconds = std::chrono::duration<double>;

/// Time between two rounds.
Seconds period(Seconds idle) {
  return std::clamp(idle / 4.0, Seconds(0.05), Seconds(30.0));
}

}  // namespace

bool is_parked(const SimulationRecord& record) {
  const bool rests = record.state == SimulationState::kReady || record.state == SimulationState::kPaused;
  return rests && !record.summary_message.empty();
}

absl::StatusOr<std::shared_ptr<Session>> find_or_wake(Backend& backend, const std::string& id) {
  if (auto session = backend.sessions.hold(id); session != nullptr) return session;
  const std::lock_guard lock(backend.waking);
  if (auto session = backend.sessions.hold(id); session != nullptr) return session;  // another was first
  const auto record = backend.store.get_simulation(id);
  if (!record.ok()) return record.status();
  if (!is_parked(*record)) return nullptr;
  return wake_simulation(backend, *record);
}

ParkingAttendant::ParkingAttendant(Backend& backend, Seconds idle) : backend_(backend), idle_(idle) {
  if (idle_.count() <= 0.0) return;
  thread_ = std::jthread([this](const std::stop_token& ending) {
    name_this_thread("parking");
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, ending, period(idle_), [&ending] { return ending.stop_requested(); })) look_round();
  });
}

ParkingAttendant::~ParkingAttendant() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void ParkingAttendant::look_round() {
  for (const auto& session : backend_.sessions.all()) {
    if (session->idle_time() >= idle_) session->park(idle_);
  }
}

}  // namespace lipofill::server
