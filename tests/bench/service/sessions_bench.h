#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/plan_file.h"

namespace lipofill::bench {

/// One daemon, one model, a number of simulations of it at once, while all of them run.
struct SessionsRow {
  int sessions = 0;
  int workers = 0;
  double wall_s = 0.0;
  double steps = 0.0;                 ///< all sessions made so many
  double fairness = 0.0;              ///< fewest steps of a session over most
  double worker_cpu_s = 0.0;          ///< the threads that step took it
  double daemon_cpu_s = 0.0;          ///< all threads took it
  int threads = 0;                    ///< most at once
  double idle_mb = 0.0;               ///< resident with the model alone
  double created_mb_a_session = 0.0;  ///< more with the simulations made
  double running_mb_a_session = 0.0;  ///< more while they run, at most
  std::string state_hash;             ///< every session ends in it
  double left_mb = 0.0;               ///< more than with the model alone once they are deleted
};

/// Runs `sessions` simulations of the plan for a simulated time [s] on a fresh daemon. Figures are
/// taken from the start of the first until the first one ends. DATA_LOSS when they do not end with
/// the same bytes.
absl::StatusOr<SessionsRow> measure_sessions(const client::PlanFile& plan, int workers, int sessions,
                                             double simulated_s);

}  // namespace lipofill::bench
