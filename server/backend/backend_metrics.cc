#include "server/backend/backend_metrics.h"

#include <algorithm>
#include <map>

namespace lipofill::server {
namespace {

constexpr SimulationState kLiveStates[] = {SimulationState::kReady, SimulationState::kRunning,
                                           SimulationState::kPaused};

void add_simulations(Backend& backend, Metrics& metrics) {
  std::map<SimulationState, prometheus::Gauge*> by_state;
  for (const SimulationState state : kLiveStates) {
    by_state[state] = &metrics.add_gauge("lipofill_simulations", "Simulations that have not ended, by state",
                                         {{"state", state_name(state)}});
  }
  auto& volume_error = metrics.add_gauge("lipofill_film_volume_relative_error",
                                         "Largest of the simulations that have not ended: |film - initial content - "
                                         "injected| / max(injected, initial content)");
  auto& memory = metrics.add_gauge("lipofill_simulation_memory_bytes",
                                   "What the simulations that have not ended are reckoned to take");
  auto& drags = metrics.add_gauge("lipofill_shape_drags", "Drags whose plans are in memory");
  auto& awaited = metrics.add_gauge("lipofill_simulations_awaited",
                                    "Simulations that could not be brought back yet since the daemon was started");
  metrics.add_refresh([&backend, by_state, &volume_error, &memory, &drags, &awaited] {
    drags.Set(static_cast<double>(backend.shapes.n_drags()));
    awaited.Set(static_cast<double>(backend.awaited.size()));
    std::map<SimulationState, int> count;
    double largest = 0.0;
    for (const SessionView& view : backend.sessions.cached_views()) {
      ++count[view.state];
      largest = std::max(largest, view.report.film_volume_relative_error);
    }
    for (const auto& [state, gauge] : by_state) gauge->Set(count[state]);
    volume_error.Set(largest);
    memory.Set(static_cast<double>(backend.sessions.memory_bytes()));
  });
}

void add_queues(Backend& backend, Metrics& metrics) {
  constexpr char kName[] = "lipofill_queue_depth";
  constexpr char kHelp[] =
      "What waits: simulations for a step, simulations for others to end, long calls, model builds";
  auto& steps = metrics.add_gauge(kName, kHelp, {{"queue", "steps"}});
  auto& starts = metrics.add_gauge(kName, kHelp, {{"queue", "starts"}});
  auto& calls = metrics.add_gauge(kName, kHelp, {{"queue", "calls"}});
  auto& builds = metrics.add_gauge(kName, kHelp, {{"queue", "builds"}});
  auto& draining = metrics.add_gauge("lipofill_draining", "1 once the daemon drains");
  metrics.add_gauge("lipofill_workers", "Threads that run simulations").Set(backend.workers.n_workers());
  metrics.add_refresh([&backend, &steps, &starts, &calls, &builds, &draining] {
    steps.Set(static_cast<double>(backend.workers.queue_depth()));
    starts.Set(static_cast<double>(backend.workers.n_waiting()));
    calls.Set(static_cast<double>(backend.calls.queue_depth()));
    builds.Set(static_cast<double>(backend.builds.queue_depth()));
    draining.Set(backend.stopping ? 1.0 : 0.0);
  });
}

}  // namespace

void add_backend_metrics(Backend& backend, Metrics& metrics) {
  add_simulations(backend, metrics);
  add_queues(backend, metrics);
}

}  // namespace lipofill::server
