#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/simulation/trial_shape.h"
#include "server/sessions/session_manager.h"
#include "server/sessions/worker_pool.h"

namespace lipofill::server {

/// A shape that was found for a request, and what it took.
struct FoundTrial {
  simulation::TrialShape& shape;
  double preparing_s = 0.0;  ///< the model and its equations
  double finding_s = 0.0;
  uint64_t superseded = 0;  ///< requests of the drag that another took the place of, so far
};

/// A request is what somebody wants to see: the settled shape of a plan with other volumes.
struct ShapeRequest {
  std::string plan;  ///< equal for equal plans on equal models
  std::function<absl::StatusOr<std::unique_ptr<simulation::TrialShape>>()> make;
  simulation::TrialVolumes volumes;
  bool from_last = false;
  Unwanted unwanted;
  /// Is called once, on any thread, with a shape when the status is OK. Nothing else touches the
  /// shape meanwhile.
  std::function<void(const absl::Status&, const FoundTrial*)> reply;
};

/// The requests of one drag: they share a plan's equations, and go on from one another's shapes. At
/// most one waits: a newer one takes its place, and it is answered with ABORTED. They take turns on
/// the workers with the simulations of the same tenant.
///
/// Checked by tests/unit/server/sessions/shape_drag_test.cc and
/// tests/integration/service/shape_test.cc.
class ShapeDrag : public WorkerPool::Task, public std::enable_shared_from_this<ShapeDrag> {
 public:
  using Clock = WorkerPool::Clock;

  /// @param place  among what is in memory, for as long as the drag is there
  ShapeDrag(WorkerPool& workers, std::string tenant, SessionManager::Place place)
      : workers_(workers), tenant_(std::move(tenant)), place_(std::move(place)) {}
  /// Answers the request that waits with draining().
  ~ShapeDrag() override;

  void ask(ShapeRequest request);
  /// Time since its last request was answered; 0 while one waits or is under way.
  Clock::duration idle_time() const;

  WorkerPool::Next take_turn() override;

 private:
  void answer(const ShapeRequest& request);
  absl::Status prepare(const ShapeRequest& request);

  WorkerPool& workers_;
  const std::string tenant_;
  mutable std::mutex mutex_;
  std::optional<ShapeRequest> waiting_;
  bool is_scheduled_ = false;  ///< the pool has it
  uint64_t superseded_ = 0;
  Clock::time_point last_use_ = Clock::now();
  // These are for the turn under way.
  SessionManager::Place place_;
  std::string plan_;  ///< of shape_
  std::unique_ptr<simulation::TrialShape> shape_;
};

}  // namespace lipofill::server
