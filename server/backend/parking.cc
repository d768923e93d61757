#include "server/backend/parking.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/error_hints.h"
#include "server/backend/simulation_recovery.h"
#include "server/sessions/thread_name.h"
#include "server/store/ownership.h"
#include "server/store/record_names.h"
#include "server/wire/names.h"

namespace lipofill::server {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr double kLeastRetryDelayS = 0.1;

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
  if (has_ended(record->state)) return nullptr;
  if (!is_parked(*record)) return no_session_for(backend, "ask for it", *record);
  return wake_simulation(backend, *record);
}

absl::Status no_session_for(Backend& backend, const char* what, const SimulationRecord& record) {
  const std::string cannot = absl::StrCat("cannot ", what, ": ", simulation_name(record.id));
  if (has_ended(record.state)) {
    return absl::FailedPreconditionError(absl::StrCat(cannot, " is ", state_name(record.state)));
  }
  if (const auto awaited = backend.awaited.find(record.id)) {
    const double delay_s = awaited->delay().count();
    return with_hints(absl::UnavailableError(
                          absl::StrCat(cannot, " is not back since the daemon was started again: it waits for this: ",
                                       awaited->waiting_for, "; the daemon tries again in ", std::ceil(delay_s), " s")),
                      {"NOT_BACK_YET", std::max(delay_s, kLeastRetryDelayS)});
  }
  if (Ownership* const ownership = ownership_of(backend.store); ownership != nullptr) {
    const auto owner = ownership->owner_of(record.id);
    if (!owner.ok()) return owner.status();
    const bool is_own = owner->has_value() && (*owner)->number == ownership->tenures()->daemon();
    if (owner->has_value() && !is_own) return owned_elsewhere(record.id, **owner);
  }
  // Its record is there, and can be listed, a moment before its session is.
  return with_hints(absl::UnavailableError(absl::StrCat(cannot, " is being made, try again")),
                    {"BEING_MADE", kLeastRetryDelayS});
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
