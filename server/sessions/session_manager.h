#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

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

  /// RESOURCE_EXHAUSTED naming the bound; UNAVAILABLE once stop_all() was called.
  absl::StatusOr<Place> reserve();
  /// False once stop_all() was called.
  [[nodiscard]] bool add(Place place, std::shared_ptr<Session> session);
  std::shared_ptr<Session> find(const std::string& id) const;
  void remove(const std::string& id);

  /// Takes no more sessions and ends all there are, with viewers closed first. Returns when every one has ended.
  void stop_all(const std::string& reason);

 private:
  std::map<std::string, std::shared_ptr<Session>> snapshot() const;

  const int max_sessions_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Session>> sessions_;
  int reserved_ = 0;
  bool stopping_ = false;
};

}  // namespace lipofill::server
