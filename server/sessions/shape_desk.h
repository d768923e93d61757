#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "server/sessions/shape_drag.h"

namespace lipofill::server {

/// The drags under way, by who makes them and what they call them. A caller has at most
/// kMostOfCaller: a new one takes the place of the one that rested longest. Of shapes without a
/// drag a caller may wait for kMostLone at once; a further one is refused with RESOURCE_EXHAUSTED,
/// for no newer one makes them unwanted. Each takes room among what is in memory, as a simulation
/// does, until it has rested for a while. Thread-safe.
///
/// Checked by tests/unit/server/sessions/shape_drag_test.cc.
class ShapeDesk {
 public:
  using Clock = ShapeDrag::Clock;
  static constexpr size_t kMostOfCaller = 4;
  static constexpr size_t kMostLone = 8;
  static constexpr Clock::duration kMostIdle = std::chrono::seconds(60);

  ShapeDesk(WorkerPool& workers, SessionManager& sessions) : workers_(workers), sessions_(sessions) {}

  /// Has a request answered.
  /// @param caller  tells callers apart
  /// @param drag    what the caller calls it; empty: it is alone, and forgotten once answered
  void ask(const std::string& tenant, const std::string& caller, const std::string& drag, ShapeRequest request);
  /// Forgets drags that have rested for so long.
  void drop_idle(Clock::duration idle = kMostIdle);
  /// Answers what waits with draining(), and everything from now on.
  void close();
  size_t n_drags() const;

 private:
  using Key = std::pair<std::string, std::string>;  ///< caller, drag
  /// Shapes without a drag that are not answered yet; the last may be after the desk has gone.
  struct LoneShapes {
    std::mutex mutex;
    std::map<std::string, size_t> of_caller;
  };
  absl::StatusOr<std::shared_ptr<ShapeDrag>> make(const std::string& tenant) const;
  absl::StatusOr<std::shared_ptr<ShapeDrag>> make_lone(const std::string& tenant, const std::string& caller,
                                                       ShapeRequest& request);
  absl::StatusOr<std::shared_ptr<ShapeDrag>> find_or_make(const std::string& tenant, const Key& key);
  /// Takes out the drag of a caller that rested longest, where the caller has all it may have.
  std::shared_ptr<ShapeDrag> make_way(const std::string& caller);

  WorkerPool& workers_;
  SessionManager& sessions_;
  mutable std::mutex mutex_;
  std::map<Key, std::shared_ptr<ShapeDrag>> drags_;
  const std::shared_ptr<LoneShapes> lone_ = std::make_shared<LoneShapes>();
  bool is_closed_ = false;
};

}  // namespace lipofill::server
