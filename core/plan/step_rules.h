#pragma once

#include <limits>
#include <optional>

#include "core/plan/simulation_spec.h"

namespace lipofill::plan {

/// Values that a goal sets for the step lengths and the tolerance that a plan does not give.
struct TimeFigures {
  std::optional<double> max_step;            ///< [s]
  std::optional<double> max_injection_step;  ///< [s]
  double error_tolerance = 0.02e-3;          ///< [m]
};

/// Returns the figures of a goal. When only the settled shape matters, steps are bounded by their
/// error alone, and that may be ten times larger: the equilibrium at the end forgets how it was
/// reached. Against injections at 10 ms steps the settled skin of the sample plans changes by less
/// than 0.005 mm (0.03 mm where fat with a yield stress never quite rests);
/// core/doc/decisions/011-settled-shape.md.
inline TimeFigures figures_of(TimeGoal goal) {
  if (goal == TimeGoal::kTransient) return {};
  return {60.0, 0.5, 0.2e-3};
}

/// The growth of steps, and the rule by which the skin is at rest.
struct StepRules {
  /// A step grows at most by this, and only when the last one was easy.
  double growth = 2.0;
  int easy_film_iterations = 30;
  int easy_newton_iterations = 4;
  /// The skin counts as at rest after this many slow steps in a row.
  int settled_steps = 5;
};

/// Returns the rules of a goal. When only the settled shape matters, a step that converges is easy
/// enough, however many of the cheap film iterations it takes, and two of the long steps that are
/// possible while the skin comes to rest tell as much as five short ones.
inline StepRules rules_of(TimeGoal goal) {
  if (goal == TimeGoal::kTransient) return {};
  StepRules rules;
  rules.growth = 4.0;
  rules.easy_film_iterations = std::numeric_limits<int>::max();
  rules.easy_newton_iterations = 8;
  rules.settled_steps = 2;
  return rules;
}

}  // namespace lipofill::plan
