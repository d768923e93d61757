// A simulation that is restored goes on as the one it was taken from, from any step of any plan.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/property/small_runs.h"

namespace lipofill::simulation {
namespace {

/// Plans whose steps are all equal, grow after the injection, or grow while it lasts.
plan::SimulationSpec pick_plan_with_any_steps() {
  plan::SimulationSpec spec = pick_plan();
  if (pick("settled shape?")) spec.goal = plan::TimeGoal::kSettledShape;
  if (pick("long steps after injecting?")) spec.max_step = 0.1;
  if (pick("long steps while injecting?")) spec.max_injection_step = 0.1;
  spec.gravity = {pick("gravity [m/s2]", 0.0, 10.0), -9.81, 2.0};
  return spec;
}

/// Each takes the same steps, and both are the same after each.
void go_on_alike(Simulation& original, Simulation& restored, int steps) {
  for (int k = 0; k < steps; ++k) {
    RC_ASSERT(restored.state_hash() == original.state_hash());
    advance(original, 1);
    advance(restored, 1);
  }
  RC_ASSERT(restored.state_hash() == original.state_hash());
  RC_ASSERT(restored.phase() == original.phase());
  RC_ASSERT(restored.report().injected == original.report().injected);
}

RC_GTEST_PROP(Snapshot, ARestoredSimulationGoesOnAsTheOneItWasTakenFrom, ()) {
  const plan::SimulationSpec spec = pick_plan_with_any_steps();
  const auto original = start(spec);
  const auto restored = start(spec);
  advance(*restored, *rc::gen::inRange(0, 4).as("steps before it is restored"));
  advance(*original, *rc::gen::inRange(0, 30).as("steps of the original"));
  RC_ASSERT(restored->restore(original->snapshot()).ok());
  go_on_alike(*original, *restored, 3);
}

/// A live injection is in the plan of the simulation that goes on from the snapshot.
RC_GTEST_PROP(Snapshot, LiveInjectionsAreInThePlanOfTheOneThatGoesOn, ()) {
  const auto original = start(pick_plan_with_any_steps());
  const int rounds = *rc::gen::inRange(1, 4).as("live injections");
  for (int k = 0; k < rounds; ++k) {
    advance(*original, *rc::gen::inRange(0, 8).as("steps before it"));
    const plan::InjectionSpec more = pick_injection();
    const auto resolved = original->resolve(more);
    RC_ASSERT(resolved.ok());
    RC_ASSERT(original->inject(more).ok());
    RC_ASSERT(original->spec().injections.back().start == resolved->start);
  }
  const auto restored = start(original->spec());
  RC_ASSERT(restored->restore(original->snapshot()).ok());
  go_on_alike(*original, *restored, 3);
}

}  // namespace
}  // namespace lipofill::simulation
