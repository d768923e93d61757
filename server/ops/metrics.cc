#include "server/ops/metrics.h"

namespace lipofill::server {
namespace {

using prometheus::BuildCounter;
using prometheus::BuildGauge;
using prometheus::BuildHistogram;
using prometheus::Counter;
using prometheus::Family;
using prometheus::Gauge;
using prometheus::Histogram;
using prometheus::Registry;

/// Boundaries from a tenth of a millisecond to ten seconds, for steps of small squares and of large
/// faces.
const Histogram::BucketBoundaries kSeconds = {0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025,
                                              0.05,   0.1,     0.25,   0.5,   1.0,    2.5,   10.0};

Family<Counter>& counters(Registry& registry, const char* name, const char* help) {
  return BuildCounter().Name(name).Help(help).Register(registry);
}

Counter& counter(Registry& registry, const char* name, const char* help) {
  return counters(registry, name, help).Add({});
}

Family<Gauge>& gauges(Registry& registry, const char* name, const char* help) {
  return BuildGauge().Name(name).Help(help).Register(registry);
}

Family<Histogram>& histograms(Registry& registry, const char* name, const char* help) {
  return BuildHistogram().Name(name).Help(help).Register(registry);
}

Counter& checkpoints(Registry& registry, const char* outcome) {
  return counters(registry, "lipofill_checkpoints_total", "Checkpoints of running simulations, by outcome")
      .Add({{"outcome", outcome}});
}

}  // namespace

Metrics::Metrics()
    : steps_(counter(registry_, "lipofill_steps_total", "Steps of all simulations")),
      step_wall_(
          histograms(registry_, "lipofill_step_wall_seconds", "Time a step took by the clock").Add({}, kSeconds)),
      factorisations_(counter(registry_, "lipofill_solver_factorisations_total", "Factorisations of the tissue")),
      tissue_solves_(counter(registry_, "lipofill_solver_solves_total", "Solves with a factor of the tissue")),
      fallbacks_(counter(registry_, "lipofill_solver_fallbacks_total",
                         "float64 in place of float32, a direct solve in place of an iterative one")),
      parked_(counter(registry_, "lipofill_simulations_parked_total", "Simulations that were left on disk alone")),
      ended_(counters(registry_, "lipofill_simulations_ended_total", "Simulations that ended, by state")),
      checkpoints_written_(checkpoints(registry_, "written")),
      checkpoints_failed_(checkpoints(registry_, "failed")),
      checkpoint_bytes_(counter(registry_, "lipofill_checkpoint_bytes_total", "Bytes of checkpoints written")),
      checkpoint_seconds_(histograms(registry_, "lipofill_checkpoint_seconds", "Time a checkpoint took by the clock")
                              .Add({}, kSeconds)),
      viewers_(gauges(registry_, "lipofill_viewers", "Viewers that watch now").Add({})),
      frames_sent_(counter(registry_, "lipofill_frames_sent_total", "Frames sent to viewers")),
      frames_skipped_(counter(registry_, "lipofill_frames_skipped_total",
                              "Frames left out because a viewer was too slow for them")),
      calls_started_(counters(registry_, "lipofill_rpc_started_total", "Calls that began, by method")),
      calls_in_flight_(gauges(registry_, "lipofill_rpc_in_flight", "Calls under way, by method")),
      calls_handled_(counters(registry_, "lipofill_rpc_handled_total", "Calls that ended, by method and status code")),
      calls_refused_(counters(registry_, "lipofill_rpc_refused_total",
                              "Calls that were refused for who made them or what they may do, by reason")),
      sent_bytes_(counters(registry_, "lipofill_rpc_sent_bytes_total", "Bytes of messages sent, by method")),
      call_seconds_(histograms(registry_, "lipofill_rpc_seconds", "Time a call took by the clock, by method")) {
  auto& phases = histograms(registry_, "lipofill_step_cpu_seconds", "CPU time of a step, by phase");
  const char* const names[] = {"element", "factor", "solve", "film", "coupling", "other"};
  for (size_t i = 0; i < step_phases_.size(); ++i) step_phases_[i] = &phases.Add({{"phase", names[i]}}, kSeconds);
  auto& iterations = counters(registry_, "lipofill_solver_iterations_total", "Iterations of the solvers, by kind");
  const char* const kinds[] = {"film", "newton", "conjugate_gradient"};
  for (size_t i = 0; i < iterations_.size(); ++i) iterations_[i] = &iterations.Add({{"kind", kinds[i]}});
  // These counters exist from the start, so that the first refusal is an increase.
  for (const char* reason : {"NO_CREDENTIALS", "ROLE_TOO_LOW", "PATIENT_NOT_YOURS"}) {
    calls_refused_.Add({{"reason", reason}});
  }
}

void Metrics::count_step(const StepFigures& step) {
  steps_.Increment();
  step_wall_.Observe(step.wall_s);
  const double phases_s[] = {step.element_cpu_s, step.factor_cpu_s, step.solve_cpu_s, step.film_cpu_s,
                             step.coupling_cpu_s};
  double other_s = step.cpu_s;
  for (size_t i = 0; i < std::size(phases_s); ++i) {
    step_phases_[i]->Observe(phases_s[i]);
    other_s -= phases_s[i];
  }
  step_phases_.back()->Observe(other_s);
  const int counts[] = {step.film_iterations, step.newton_iterations, step.iterative_iterations};
  for (size_t i = 0; i < std::size(counts); ++i) iterations_[i]->Increment(counts[i]);
  factorisations_.Increment(step.factorisations);
  tissue_solves_.Increment(step.tissue_solves);
  fallbacks_.Increment(step.fallbacks);
}

void Metrics::count_ended_simulation(const std::string& state) {
  ended_.Add({{"state", state}}).Increment();
}

void Metrics::count_parked_simulation() {
  parked_.Increment();
}

void Metrics::count_checkpoint(double seconds, uint64_t bytes) {
  checkpoints_written_.Increment();
  checkpoint_bytes_.Increment(static_cast<double>(bytes));
  checkpoint_seconds_.Observe(seconds);
}

void Metrics::count_failed_checkpoint() {
  checkpoints_failed_.Increment();
}

void Metrics::count_frame_sent(uint64_t skipped_before) {
  frames_sent_.Increment();
  frames_skipped_.Increment(static_cast<double>(skipped_before));
}

MethodMetrics Metrics::of_method(const std::string& method) {
  const prometheus::Labels labels = {{"method", method}};
  return {calls_started_.Add(labels), calls_in_flight_.Add(labels), sent_bytes_.Add(labels),
          call_seconds_.Add(labels, kSeconds)};
}

void Metrics::count_handled(const std::string& method, const std::string& code) {
  calls_handled_.Add({{"method", method}, {"code", code}}).Increment();
}

void Metrics::count_refused(const std::string& reason) {
  calls_refused_.Add({{"reason", reason}}).Increment();
}

Gauge& Metrics::add_gauge(const std::string& name, const std::string& help, const prometheus::Labels& labels) {
  return BuildGauge().Name(name).Help(help).Register(registry_).Add(labels);
}

Counter& Metrics::add_counter(const std::string& name, const std::string& help) {
  return BuildCounter().Name(name).Help(help).Register(registry_).Add({});
}

void Metrics::add_refresh(std::function<void()> refresh) {
  const std::lock_guard lock(refresh_mutex_);
  refreshes_.push_back(std::move(refresh));
}

std::vector<prometheus::MetricFamily> Metrics::collect() const {
  const std::lock_guard lock(refresh_mutex_);
  for (const auto& refresh : refreshes_) refresh();
  return registry_.Collect();
}

}  // namespace lipofill::server
