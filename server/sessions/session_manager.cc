#include "server/sessions/session_manager.h"

#include <future>
#include <vector>

#include "absl/strings/str_cat.h"

namespace lipofill::server {

SessionManager::Place::~Place() {
  if (manager_ == nullptr) return;
  const std::lock_guard lock(manager_->mutex_);
  --manager_->reserved_;
}

absl::StatusOr<SessionManager::Place> SessionManager::reserve() {
  const std::lock_guard lock(mutex_);
  if (stopping_) return absl::UnavailableError("the daemon is stopping");
  if (static_cast<int>(sessions_.size()) + reserved_ >= max_sessions_) {
    return absl::ResourceExhaustedError(absl::StrCat("there are ", sessions_.size(),
                                                     " simulations that have not ended, the bound is ", max_sessions_,
                                                     "; stop or delete one"));
  }
  ++reserved_;
  return Place(this);
}

bool SessionManager::add(Place, std::shared_ptr<Session> session) {
  const std::lock_guard lock(mutex_);
  if (stopping_) return false;
  sessions_[session->id()] = std::move(session);
  return true;
}

std::shared_ptr<Session> SessionManager::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  return found == sessions_.end() ? nullptr : found->second;
}

void SessionManager::remove(const std::string& id) {
  std::shared_ptr<Session> last;  // destroyed outside the lock
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found == sessions_.end()) return;
  last = std::move(found->second);
  sessions_.erase(found);
}

std::map<std::string, std::shared_ptr<Session>> SessionManager::snapshot() const {
  const std::lock_guard lock(mutex_);
  return sessions_;
}

void SessionManager::stop_all(const std::string& reason) {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  std::vector<std::future<void>> ended;
  for (const auto& [id, session] : snapshot()) {
    session->close_viewers(absl::UnavailableError(reason));
    auto done = std::make_shared<std::promise<void>>();
    ended.push_back(done->get_future());
    session->stop(reason, [done](const absl::StatusOr<SessionView>&) { done->set_value(); });
  }
  for (auto& end : ended) end.wait();
}

}  // namespace lipofill::server
