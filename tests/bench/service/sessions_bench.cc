#include "tests/bench/service/sessions_bench.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include "absl/strings/str_cat.h"
#include "tests/bench/service/process_figures.h"
#include "tests/bench/service/served_plan.h"

namespace lipofill::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Steps so far.
struct Progress {
  double steps = 0.0;
  double fairness = 0.0;
  bool all_run = true;
};

absl::StatusOr<Progress> read_progress(const ServedPlan& served) {
  const auto simulations = served.list();
  if (!simulations.ok()) return simulations.status();
  Progress progress;
  double fewest = 1e300;
  double most = 0.0;
  for (const v1::Simulation& simulation : *simulations) {
    const auto steps = static_cast<double>(simulation.summary().steps());
    progress.steps += steps;
    fewest = std::min(fewest, steps);
    most = std::max(most, steps);
    progress.all_run = progress.all_run && simulation.state() == v1::Simulation::RUNNING;
  }
  progress.fairness = most > 0.0 ? fewest / most : 0.0;
  return progress;
}

std::string id_of(int session) {
  return absl::StrCat("x", session);
}

absl::Status follow(const ServedPlan& served, SessionsRow& row) {
  const ProcessFigures before = read_process(served.daemon());
  const Clock::time_point begin = Clock::now();
  double most_mb = 0.0;
  while (true) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const auto progress = read_progress(served);
    if (!progress.ok()) return progress.status();
    const ProcessFigures now = read_process(served.daemon());
    most_mb = std::max(most_mb, now.resident_mb);
    if (!progress->all_run) break;
    row.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
    row.steps = progress->steps;
    row.fairness = progress->fairness;
    row.worker_cpu_s = now.cpu_s_of_name("worker") - before.cpu_s_of_name("worker");
    row.daemon_cpu_s = now.cpu_s - before.cpu_s;
    row.threads = std::max(row.threads, now.threads);
  }
  row.running_mb_a_session = (most_mb - row.idle_mb) / row.sessions;
  return absl::OkStatus();
}

absl::Status compare_ends(const ServedPlan& served, SessionsRow& row) {
  for (int k = 0; k < row.sessions; ++k) {
    const auto end = served.await_end(id_of(k));
    if (!end.ok()) return end.status();
    const std::string& hash = end->summary().state_hash();
    if (k == 0) row.state_hash = hash;
    if (hash != row.state_hash) {
      return absl::DataLossError(absl::StrCat(end->name(), " ends with hash ", hash, ", others with ", row.state_hash));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SessionsRow> measure_sessions(const client::PlanFile& plan, int workers, int sessions,
                                             double simulated_s) {
  const auto served = ServedPlan::start(plan, workers);
  if (!served.ok()) return served.status();
  SessionsRow row;
  row.sessions = sessions;
  row.workers = workers;
  row.idle_mb = read_process((*served)->daemon()).resident_mb;
  absl::Status status;
  for (int k = 0; k < sessions && status.ok(); ++k) status = (*served)->create(id_of(k), simulated_s);
  row.created_mb_a_session = (read_process((*served)->daemon()).resident_mb - row.idle_mb) / sessions;
  for (int k = 0; k < sessions && status.ok(); ++k) status = (*served)->start(id_of(k));
  if (status.ok()) status = follow(**served, row);
  if (status.ok()) status = compare_ends(**served, row);
  for (int k = 0; k < sessions && status.ok(); ++k) status = (*served)->remove(id_of(k));
  if (!status.ok()) return status;
  row.left_mb = read_process((*served)->daemon()).resident_mb - row.idle_mb;
  return row;
}

}  // namespace lipofill::bench
