#include "server/sessions/session_manager.h"

#include <future>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/sessions/draining.h"
#include "server/sessions/shortage.h"

namespace lipofill::server {
namespace {

constexpr double kRetryDelayS = 10.0;

uint64_t to_mb(uint64_t bytes) {
  return bytes / 1'000'000;
}

}  // namespace

SessionManager::Place::~Place() {
  if (manager_ == nullptr) return;
  const std::lock_guard lock(manager_->mutex_);
  manager_->give_back(tenant_, bytes_);
}

absl::Status SessionManager::Place::claim(uint64_t bytes) {
  const std::lock_guard lock(manager_->mutex_);
  const uint64_t bound = manager_->bounds_.memory_bytes;
  const uint64_t taken = manager_->bytes_taken_;
  if (bytes > bound || taken > bound - bytes) {
    return shortage(
        "NO_MEMORY", kRetryDelayS,
        absl::StrCat("the simulation takes ", to_mb(bytes), " MB and those in memory ", to_mb(taken),
                     " MB, the bound is ", to_mb(bound), " MB; stop or delete one, or take a smaller model"));
  }
  manager_->bytes_taken_ += bytes;
  bytes_ += bytes;
  return absl::OkStatus();
}

void SessionManager::Place::unclaim() {
  const std::lock_guard lock(manager_->mutex_);
  manager_->bytes_taken_ -= std::exchange(bytes_, 0);
}

void SessionManager::take(const std::string& tenant) {
  ++n_taken_;
  ++n_taken_by_[tenant];
}

void SessionManager::give_back(const std::string& tenant, uint64_t bytes) {
  --n_taken_;
  if (--n_taken_by_[tenant] == 0) n_taken_by_.erase(tenant);
  bytes_taken_ -= bytes;
}

absl::StatusOr<SessionManager::Place> SessionManager::reserve(const std::string& tenant) {
  const std::lock_guard lock(mutex_);
  if (stopping_) return draining();
  if (n_taken_ >= bounds_.simulations) {
    return shortage("TOO_MANY_SIMULATIONS", kRetryDelayS,
                    absl::StrCat("there are ", n_taken_, " simulations that have not ended, the bound is ",
                                 bounds_.simulations, "; stop or delete one"));
  }
  const auto own = n_taken_by_.find(tenant);
  if (own != n_taken_by_.end() && own->second >= bounds_.simulations_per_tenant) {
    return shortage(
        "TOO_MANY_SIMULATIONS_OF_TENANT", kRetryDelayS,
        absl::StrCat("you have ", own->second, " simulations that have not ended, the bound for each tenant is ",
                     bounds_.simulations_per_tenant, "; stop or delete one"));
  }
  take(tenant);
  return Place(this, tenant);
}

bool SessionManager::add(Place place, std::shared_ptr<Session> session) {
  const std::lock_guard lock(mutex_);
  if (stopping_) {
    give_back(place.tenant_, place.bytes_);
    place.manager_ = nullptr;
    return false;
  }
  sessions_[session->id()] = {session, place.tenant_, place.bytes_};
  place.manager_ = nullptr;  // the session has it now
  return true;
}

std::shared_ptr<Session> SessionManager::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  return found == sessions_.end() ? nullptr : found->second.session;
}

std::shared_ptr<Session> SessionManager::hold(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  return found == sessions_.end() ? nullptr : server::hold(found->second.session);
}

void SessionManager::remove(const std::string& id) {
  std::shared_ptr<Session> last;  // destroyed outside the lock
  const std::lock_guard lock(mutex_);
  last = take_out(id);
}

bool SessionManager::remove_unless_held(const std::string& id) {
  std::shared_ptr<Session> last;
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found != sessions_.end() && found->second.session->is_held()) return false;
  last = take_out(id);
  return true;
}

std::shared_ptr<Session> SessionManager::take_out(const std::string& id) {
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return nullptr;
  std::shared_ptr<Session> session = std::move(found->second.session);
  give_back(found->second.tenant, found->second.bytes);
  sessions_.erase(found);
  return session;
}

std::vector<std::shared_ptr<Session>> SessionManager::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<Session>> sessions;
  for (const auto& [id, entry] : sessions_) sessions.push_back(entry.session);
  return sessions;
}

uint64_t SessionManager::memory_bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_taken_;
}

bool SessionManager::bring_back(const std::string& tenant, uint64_t bytes, std::shared_ptr<Session> session) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return false;
    take(tenant);
    bytes_taken_ += bytes;
    sessions_[session->id()] = {session, tenant, bytes};
  }
  session->go_on();
  return true;
}

void SessionManager::suspend_all() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  std::vector<std::future<void>> answers;
  for (const auto& session : all()) {
    session->close_viewers(draining());
    // State that could not be kept is in the log; the simulation then goes on from an earlier one.
    const auto done = std::make_shared<std::promise<void>>();
    answers.push_back(done->get_future());
    session->suspend(draining(), [done](const absl::Status&) { done->set_value(); });
  }
  for (auto& answer : answers) answer.get();
}

std::vector<SessionView> SessionManager::cached_views() const {
  std::vector<SessionView> views;
  for (const auto& session : all()) views.push_back(session->cached_view());
  return views;
}

}  // namespace lipofill::server
