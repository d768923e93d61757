#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/plan_file.h"

namespace lipofill::bench {

/// One simulation on one worker, watched by a number of viewers, each on a connection of its own.
struct ViewersRow {
  int viewers = 0;
  double steps = 0.0;
  double wall_s = 0.0;
  double worker_cpu_s = 0.0;     ///< the thread that steps took it
  double transport_cpu_s = 0.0;  ///< the daemon's other threads took it to encode and send
  double frames = 0.0;           ///< seen by a viewer, mean
  double sent_mb = 0.0;          ///< all viewers together were sent it
};

/// Runs the plan for a simulated time [s] with each number of viewers in turn, `rounds` times over,
/// on one daemon. A row a number of viewers: the run with the median of worker_cpu_s. Viewers watch
/// the meshes named (none: what the daemon shows who names none), LATEST, every step.
absl::StatusOr<std::vector<ViewersRow>> measure_viewers(const client::PlanFile& plan, const std::vector<int>& viewers,
                                                        const std::vector<std::string>& meshes, double simulated_s,
                                                        int rounds);

}  // namespace lipofill::bench
