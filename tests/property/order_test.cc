// Neither the order in which injections are named nor when they are ordered changes what they do.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/property/small_runs.h"

namespace lipofill::simulation {
namespace {

constexpr int kSteps = 20;

/// A plan whose injections start when they say.
plan::SimulationSpec pick_timed_plan() {
  plan::SimulationSpec spec = pick_plan();
  for (plan::InjectionSpec& injection : spec.injections) injection.start = pick("start [s]", 0.0, 0.1);
  return spec;
}

/// Sums in another order round in another way, and nothing else.
void expect_alike(const Simulation& a, const Simulation& b) {
  RC_ASSERT(std::abs(a.report().injected - b.report().injected) <= 1e-12 * b.report().injected);
  RC_ASSERT(difference(skin_displacement(a), skin_displacement(b)) <= 1e-5);
}

RC_GTEST_PROP(Order, OfInjectionsInAPlanDoesNotMatter, ()) {
  const plan::SimulationSpec spec = pick_timed_plan();
  plan::SimulationSpec turned = spec;
  std::reverse(turned.injections.begin(), turned.injections.end());
  const auto a = start(spec), b = start(turned);
  advance(*a, kSteps);
  advance(*b, kSteps);
  expect_alike(*a, *b);
}

RC_GTEST_PROP(Order, OfLiveInjectionsDoesNotMatter, ()) {
  const plan::SimulationSpec spec = pick_timed_plan();
  const auto a = start(spec), b = start(spec);
  plan::InjectionSpec first = pick_injection(), second = pick_injection();
  const int before = *rc::gen::inRange(0, 10).as("steps before");
  advance(*a, before);
  advance(*b, before);
  first.start = second.start = 0.01 * before + pick("start of both [s]", 0.0, 0.05);
  RC_ASSERT(a->inject(first).ok() && a->inject(second).ok());
  RC_ASSERT(b->inject(second).ok() && b->inject(first).ok());
  advance(*a, kSteps);
  advance(*b, kSteps);
  expect_alike(*a, *b);
}

RC_GTEST_PROP(Order, AnInjectionOrderedInTimeIsAsOneOfThePlan, ()) {
  const plan::SimulationSpec spec = pick_timed_plan();
  plan::InjectionSpec more = pick_injection();
  const int before = *rc::gen::inRange(0, 10).as("steps before");
  more.start = 0.01 * before + 0.1;
  plan::SimulationSpec whole = spec;
  whole.injections.push_back(more);
  const auto planned = start(whole), live = start(spec);
  advance(*live, before);
  RC_ASSERT(live->inject(more).ok());
  advance(*live, kSteps);
  advance(*planned, before + kSteps);
  RC_ASSERT(live->state_hash() == planned->state_hash());
}

}  // namespace
}  // namespace lipofill::simulation
