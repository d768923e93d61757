#include "server/sessions/session_manager.h"

#include <future>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/sessions/draining.h"

namespace lipofill::server {

SessionManager::Place::~Place() {
  if (manager_ == nullptr) return;
  const std::lock_guard lock(manager_->mutex_);
  --manager_->reserved_;
}

absl::StatusOr<SessionManager::Place> SessionManager::reserve() {
  const std::lock_guard lock(mutex_);
  if (stopping_) return draining();
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

void SessionManager::bring_back(std::shared_ptr<Session> session) {
  {
    const std::lock_guard lock(mutex_);
    sessions_[session->id()] = session;
  }
  session->go_on();
}

absl::Status SessionManager::ask_all(const Act& act) const {
  std::vector<std::future<absl::Status>> answers;
  for (const auto& [id, session] : snapshot()) {
    auto done = std::make_shared<std::promise<absl::Status>>();
    answers.push_back(done->get_future());
    act(*session, [done](absl::Status status) { done->set_value(std::move(status)); });
  }
  absl::Status all;
  for (auto& answer : answers) all.Update(answer.get());
  return all;
}

absl::Status SessionManager::checkpoint_all() {
  return ask_all([](Session& session, Session::Done done) { session.save(std::move(done)); });
}

void SessionManager::suspend_all() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  // What could not be kept is in the log; the simulation then goes on from an earlier state.
  ask_all([](Session& session, Session::Done done) {
    session.close_viewers(draining());
    session.suspend(std::move(done));
  }).IgnoreError();
}

std::vector<SessionView> SessionManager::cached_views() const {
  std::vector<SessionView> views;
  for (const auto& [id, session] : snapshot()) views.push_back(session->cached_view());
  return views;
}

}  // namespace lipofill::server
