#include "server/ops/step_metrics.h"

#include <iterator>

namespace lipofill::server {

StepMetrics::StepMetrics(prometheus::Registry& registry)
    : steps_(add_counter(registry, "lipofill_steps_total", "Steps of all simulations")),
      wall_(add_histograms(registry, "lipofill_step_wall_seconds", "Time a step took by the clock")
                .Add({}, kSecondsBoundaries)),
      factorisations_(add_counter(registry, "lipofill_solver_factorisations_total", "Factorisations of the tissue")),
      tissue_solves_(add_counter(registry, "lipofill_solver_solves_total", "Solves with a factor of the tissue")),
      fallbacks_(add_counter(registry, "lipofill_solver_fallbacks_total",
                             "float64 in place of float32, a direct solve in place of an iterative one")) {
  auto& phases = add_histograms(registry, "lipofill_step_cpu_seconds", "CPU time of a step, by phase");
  const char* const names[] = {"element", "factor", "solve", "film", "coupling", "other"};
  for (size_t i = 0; i < phases_.size(); ++i) phases_[i] = &phases.Add({{"phase", names[i]}}, kSecondsBoundaries);
  auto& iterations = add_counters(registry, "lipofill_solver_iterations_total", "Iterations of the solvers, by kind");
  const char* const kinds[] = {"film", "newton", "conjugate_gradient"};
  for (size_t i = 0; i < iterations_.size(); ++i) iterations_[i] = &iterations.Add({{"kind", kinds[i]}});
}

void StepMetrics::count(const StepFigures& step) {
  steps_.Increment();
  wall_.Observe(step.wall_s);
  const double phases_s[] = {step.element_cpu_s, step.factor_cpu_s, step.solve_cpu_s, step.film_cpu_s,
                             step.coupling_cpu_s};
  double other_s = step.cpu_s;
  for (size_t i = 0; i < std::size(phases_s); ++i) {
    phases_[i]->Observe(phases_s[i]);
    other_s -= phases_s[i];
  }
  phases_.back()->Observe(other_s);
  const int counts[] = {step.film_iterations, step.newton_iterations, step.iterative_iterations};
  for (size_t i = 0; i < std::size(counts); ++i) iterations_[i]->Increment(counts[i]);
  factorisations_.Increment(step.factorisations);
  tissue_solves_.Increment(step.tissue_solves);
  fallbacks_.Increment(step.fallbacks);
}

}  // namespace lipofill::server
