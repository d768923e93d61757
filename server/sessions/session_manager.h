#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/sessions/session.h"

namespace lipofill::server {

/// The simulations in memory: those that have not ended. Their number is bounded.
/// Checked by tests/unit/server/session_test.cc.
class SessionManager {
 public:
  explicit SessionManager(int max_sessions) : max_sessions_(max_sessions) {}

  /// Room for one more, given back when it is not used.
  class Place {
   public:
    Place(Place&& other) noexcept : manager_(std::exchange(other.manager_, nullptr)) {}
    Place& operator=(Place&&) = delete;
    ~Place();

   private:
    friend class SessionManager;
    explicit Place(SessionManager* manager) : manager_(manager) {}
    SessionManager* manager_;
  };

  /// RESOURCE_EXHAUSTED naming the bound; draining() once suspend_all() was called.
  absl::StatusOr<Place> reserve();
  /// False once suspend_all() was called.
  [[nodiscard]] bool add(Place place, std::shared_ptr<Session> session);
  std::shared_ptr<Session> find(const std::string& id) const;
  void remove(const std::string& id);
  /// Adds one that was there before the daemon was started again, whatever the bound, and lets it go on.
  void bring_back(std::shared_ptr<Session> session);

  /// Has every session keep its state; they go on meanwhile. Returns when all are done, with the first error.
  absl::Status checkpoint_all();
  /// For the end of the daemon: takes no more sessions, ends viewers' streams with draining(), has every session keep
  /// its state and take no step or command any more. Returns when all are done.
  void suspend_all();
  /// Figures of all, each as after its last step.
  std::vector<SessionView> cached_views() const;

 private:
  std::map<std::string, std::shared_ptr<Session>> snapshot() const;
  using Act = std::function<void(Session& session, Session::Done done)>;
  /// Has all sessions act, each in its own time, and waits for them; the first error.
  absl::Status ask_all(const Act& act) const;

  const int max_sessions_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Session>> sessions_;
  int reserved_ = 0;
  bool stopping_ = false;
};

}  // namespace lipofill::server
