#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/sessions/session.h"

namespace lipofill::server {

/// Bounds on all simulations in memory together.
struct SessionBounds {
  int simulations = 64;
  int simulations_per_tenant = 64;
  uint64_t memory_bytes = uint64_t{8} << 30;
};

/// The simulations in memory: those that have not ended, but for those that are parked. Their
/// number, of all and of each tenant, and what they take are bounded. Checked by
/// tests/unit/server/sessions/session_manager_test.cc.
class SessionManager {
 public:
  explicit SessionManager(const SessionBounds& bounds) : bounds_(bounds) {}

  /// Room for one more, given back when it is not used.
  class Place {
   public:
    Place(Place&& other) noexcept
        : manager_(std::exchange(other.manager_, nullptr)), tenant_(std::move(other.tenant_)), bytes_(other.bytes_) {}
    Place& operator=(Place&&) = delete;
    ~Place();
    /// Claims memory, once it is known how much the session will take. RESOURCE_EXHAUSTED naming
    /// the bound.
    absl::Status claim(uint64_t bytes);
    /// Gives back what was claimed.
    void unclaim();

   private:
    friend class SessionManager;
    Place(SessionManager* manager, std::string tenant) : manager_(manager), tenant_(std::move(tenant)) {}
    SessionManager* manager_;
    std::string tenant_;
    uint64_t bytes_ = 0;
  };

  /// Reserves room for a session. RESOURCE_EXHAUSTED naming the bound; draining() once
  /// suspend_all() was called.
  absl::StatusOr<Place> reserve(const std::string& tenant);
  /// Adds the session; false once suspend_all() was called.
  [[nodiscard]] bool add(Place place, std::shared_ptr<Session> session);
  /// Finds a session only to look at it: it may be parked at any moment.
  std::shared_ptr<Session> find(const std::string& id) const;
  /// Finds a session that is about to be asked something; see hold(Session).
  std::shared_ptr<Session> hold(const std::string& id) const;
  void remove(const std::string& id);
  /// Removes the session, unless it is held: then it stays and this returns false.
  [[nodiscard]] bool remove_unless_held(const std::string& id);
  /// Adds one that was there before the daemon was started again, whatever the bounds, and lets it
  /// go on; false once suspend_all() was called.
  bool bring_back(const std::string& tenant, uint64_t bytes, std::shared_ptr<Session> session);

  /// Ends all sessions when the daemon ends: takes no more of them, ends viewers' streams with
  /// draining(), has every session keep its state and take no step or command any more. Returns
  /// when all are done.
  void suspend_all();
  /// Figures of all, each as after its last step.
  std::vector<SessionView> cached_views() const;
  std::vector<std::shared_ptr<Session>> all() const;
  /// Memory that they take, as far as it is known.
  uint64_t memory_bytes() const;

 private:
  struct Entry {
    std::shared_ptr<Session> session;
    std::string tenant;
    uint64_t bytes = 0;
  };
  // These must be called with the mutex held.
  void take(const std::string& tenant);
  void give_back(const std::string& tenant, uint64_t bytes);
  std::shared_ptr<Session> take_out(const std::string& id);

  const SessionBounds bounds_;
  mutable std::mutex mutex_;
  std::map<std::string, Entry> sessions_;
  /// Number of sessions and of reserved places.
  int n_taken_ = 0;
  std::map<std::string, int> n_taken_by_;
  uint64_t bytes_taken_ = 0;
  bool stopping_ = false;
};

}  // namespace lipofill::server
