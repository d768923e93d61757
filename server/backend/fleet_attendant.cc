#include "server/backend/fleet_attendant.h"

#include <algorithm>
#include <chrono>
#include <map>

#include "absl/strings/str_format.h"
#include "server/backend/parking.h"
#include "server/sessions/thread_name.h"
#include "server/store/record_names.h"
#include "spdlog/spdlog.h"

namespace lipofill::server {
namespace {

constexpr std::chrono::milliseconds kPeriod{500};
constexpr size_t kArrivalsPerWorker = 4;

LeaseClock::duration to_duration(double seconds) {
  return std::chrono::duration_cast<LeaseClock::duration>(std::chrono::duration<double>(seconds));
}

/// Has a simulation brought back without a pause before.
void await_now(Backend& backend, const std::string& id, const std::string& why) {
  backend.awaited.note(id, why, 0, Awaited::Clock::now() - std::chrono::minutes(1));
}

std::string describe(const Orphan& orphan) {
  if (!orphan.age_s) return "";
  return absl::StrFormat("; %s was last heard of %.1f s ago", orphan.daemon, *orphan.age_s);
}

}  // namespace

/// Sessions that are let go of: each takes no step and no command any more, and leaves memory once
/// its step at hand has ended. It tries to keep its state, which the store refuses where another
/// owns it by now. It outlasts the attendant where a step takes long.
class FleetAttendant::Departures : public std::enable_shared_from_this<Departures> {
 public:
  explicit Departures(Backend& backend) : backend_(backend) {}

  void let_go(const std::shared_ptr<Session>& session, const absl::Status& why) {
    {
      const std::lock_guard lock(mutex_);
      const auto [going, is_new] = gone_.emplace(session->id(), false);
      if (!is_new && !going->second) return;  // it is on its way
      going->second = false;
      ++n_let_go_;
    }
    spdlog::warn("{} is let go of: {}", simulation_name(session->id()), std::string(why.message()));
    session->close_viewers(why);
    session->suspend(why, [self = shared_from_this(), id = session->id()](const absl::Status&) {
      self->backend_.sessions.remove(id);
      const std::lock_guard lock(self->mutex_);
      self->gone_[id] = true;
    });
    session->close_viewers(why);  // who came before it was suspended
  }
  /// True, once, for a simulation whose session has gone.
  bool take_gone(const std::string& id) {
    const std::lock_guard lock(mutex_);
    const auto found = gone_.find(id);
    if (found == gone_.end() || !found->second) return false;
    gone_.erase(found);
    return true;
  }
  uint64_t n_let_go() const {
    const std::lock_guard lock(mutex_);
    return n_let_go_;
  }

 private:
  Backend& backend_;
  mutable std::mutex mutex_;
  std::map<std::string, bool> gone_;  ///< true: it has left memory
  uint64_t n_let_go_ = 0;
};

FleetAttendant::FleetAttendant(Backend& backend, Ownership& ownership)
    : backend_(backend), ownership_(ownership), departures_(std::make_shared<Departures>(backend)) {
  add_metrics();
  thread_ = std::jthread([this](const std::stop_token& ending) {
    name_this_thread("fleet");
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, ending, kPeriod, [&ending] { return ending.stop_requested(); })) look_round();
  });
}

FleetAttendant::~FleetAttendant() {
  thread_.request_stop();
  thread_.join();
}

void FleetAttendant::look_round() {
  if (ownership_.has_left()) return;
  if (LeaseClock::now() - renewal_ >= kLeaseRenewal - kPeriod / 2) renew();
  if (!ownership_.is_held()) return stand_still();
  if (backend_.stopping) return;
  compare();
  note_arrivals();
  take_over();
}

// Others may own by now what was in memory when the lease ended: it goes before this daemon acts
// on its new lease.
void FleetAttendant::renew() {
  renewal_ = LeaseClock::now();
  const auto end = ownership_.renew();
  tell(end.status());
  if (!end.ok()) return;
  if (!ownership_.is_held()) stand_still();
  ownership_.tenures()->extend(*end);
}

void FleetAttendant::tell(const absl::Status& status) {
  std::string message(status.message());
  if (message == told_) return;
  told_ = std::move(message);
  if (status.ok()) return spdlog::info("the lease of this daemon, {}, is renewed again", ownership_.name());
  spdlog::error("the lease of this daemon, {}, is not renewed: {}", ownership_.name(), told_);
}

void FleetAttendant::stand_still() {
  for (const auto& session : backend_.sessions.all()) departures_->let_go(session, no_lease());
}

void FleetAttendant::compare() {
  const auto held = ownership_.tenures()->all();
  const auto own = ownership_.list_own();
  if (!own.ok()) return;
  std::map<std::string, uint64_t> doubtful;
  for (const auto& [id, epoch] : held) {
    const auto row = own->find(id);
    if (row == own->end() || row->second != epoch) doubtful[id] = epoch;
  }
  // One that has ended, or is being made, is in doubt for a moment.
  for (const auto& [id, epoch] : doubtful) {
    const auto before = doubtful_.find(id);
    if (before != doubtful_.end() && before->second == epoch) give_up(id, epoch);
  }
  doubtful_ = std::move(doubtful);
  for (const auto& [id, epoch] : *own) {
    const auto known = ownership_.tenures()->epoch_of(id);
    if (known == epoch) {
      bring_back_own(id, epoch);
    } else if (!known) {
      spdlog::error("{} is this daemon's by the database, which this daemon knows nothing of: it is given back",
                    simulation_name(id));
      ownership_.give_back(id, epoch);
    }
  }
}

void FleetAttendant::give_up(const std::string& id, uint64_t epoch) {
  if (!backend_.store.get_simulation(id).ok()) return;  // it is being made
  const auto owner = ownership_.owner_of(id);
  if (!owner.ok() || ownership_.tenures()->epoch_of(id) != epoch) return;
  if (const auto session = backend_.sessions.find(id); session != nullptr) {
    DaemonRecord nobody;
    nobody.name = "that had it last";
    return departures_->let_go(session, owned_elsewhere(id, owner->value_or(nobody)));
  }
  departures_->take_gone(id);
  backend_.awaited.forget(id);
  ownership_.tenures()->forget(id, epoch);
}

/// Has one come back that was let go of when there was no lease.
void FleetAttendant::bring_back_own(const std::string& id, uint64_t epoch) {
  if (!departures_->take_gone(id)) return;
  const auto record = backend_.store.get_simulation(id);
  if (!record.ok()) return;
  if (has_ended(record->state) || is_parked(*record)) return ownership_.give_back(id, epoch);
  await_now(backend_, id, "this daemon had no lease for a while");
}

// A few at a time, and each daemon begins elsewhere in the list, so that those that live share what
// a dead one had.
void FleetAttendant::take_over() {
  auto orphans = ownership_.list_orphans();
  if (!orphans.ok() || orphans->empty()) return;
  const auto first = static_cast<size_t>(ownership_.tenures()->daemon()) % orphans->size();
  std::rotate(orphans->begin(), orphans->begin() + static_cast<std::ptrdiff_t>(first), orphans->end());
  const size_t most_at_once = kArrivalsPerWorker * static_cast<size_t>(backend_.workers.n_workers());
  for (const Orphan& orphan : *orphans) {
    if (arrivals_.size() >= most_at_once || is_full()) return;
    const std::string& id = orphan.simulation;
    if (backend_.awaited.find(id) || ownership_.tenures()->epoch_of(id) || backend_.sessions.find(id) != nullptr) {
      continue;
    }
    const absl::Status taken = ownership_.take(id);
    if (!taken.ok()) continue;  // another was quicker
    spdlog::warn("{} has no daemon that lives: it goes on here{}", simulation_name(id), describe(orphan));
    if (orphan.age_s) arrivals_[id] = LeaseClock::now() - to_duration(*orphan.age_s);
    await_now(backend_, id, "its daemon died, and this one takes it over");
  }
}

/// True where no more fits in memory here: others take what is left, or it waits.
bool FleetAttendant::is_full() {
  const SessionBounds& bounds = backend_.options.sessions;
  const size_t n_here = backend_.sessions.all().size() + backend_.awaited.size();
  const bool is_full =
      n_here >= static_cast<size_t>(bounds.simulations) || backend_.sessions.memory_bytes() >= bounds.memory_bytes;
  if (is_full && !was_full_) spdlog::warn("this daemon is full: simulations without a daemon wait for another");
  was_full_ = is_full;
  return is_full;
}

/// Tells how long those that were taken over stood still.
void FleetAttendant::note_arrivals() {
  std::erase_if(arrivals_, [this](const auto& arrival) {
    const auto& [id, last_heard] = arrival;
    if (backend_.sessions.find(id) != nullptr) {
      last_takeover_s_ = std::chrono::duration<double>(LeaseClock::now() - last_heard).count();
      spdlog::info("{} is here, {:.1f} s after the last sign of life of its daemon", simulation_name(id),
                   last_takeover_s_.load());
      return true;
    }
    const auto awaited = backend_.awaited.find(id);
    const bool is_on_its_way = awaited && awaited->attempts <= 1;
    return !is_on_its_way || !ownership_.tenures()->epoch_of(id);
  });
}

void FleetAttendant::add_metrics() {
  auto& owned = backend_.metrics.add_gauge("lipofill_simulations_owned", "Simulations that this daemon owns");
  auto& age = backend_.metrics.add_gauge("lipofill_lease_age_seconds", "Time since this daemon renewed its lease");
  auto& held = backend_.metrics.add_gauge("lipofill_lease_held", "1 while this daemon has a lease");
  auto& daemons = backend_.metrics.add_gauge("lipofill_fleet_daemons", "Daemons of the database that live");
  auto& last = backend_.metrics.add_gauge("lipofill_last_takeover_seconds",
                                          "Time from the last sign of life of a daemon until what was taken over from "
                                          "it went on here, the last time");
  auto& takeovers = backend_.metrics.add_counter("lipofill_takeovers_total",
                                                 "Simulations that this daemon took over from one that did not live");
  auto& let_go = backend_.metrics.add_counter(
      "lipofill_simulations_let_go_total",
      "Simulations that this daemon let go of, as its lease had ended or another had taken them");
  backend_.metrics.add_refresh([this, &owned, &age, &held, &daemons, &last, &takeovers, &let_go] {
    last.Set(last_takeover_s_);
    owned.Set(static_cast<double>(ownership_.tenures()->all().size()));
    age.Set(ownership_.lease_age().count());
    held.Set(ownership_.is_held() ? 1.0 : 0.0);
    if (const auto all = ownership_.list_daemons(); all.ok()) {
      daemons.Set(static_cast<double>(
          std::count_if(all->begin(), all->end(), [](const DaemonRecord& daemon) { return daemon.is_live; })));
    }
    takeovers.Increment(static_cast<double>(ownership_.n_takeovers()) - takeovers.Value());
    let_go.Increment(static_cast<double>(departures_->n_let_go()) - let_go.Value());
  });
}

}  // namespace lipofill::server
