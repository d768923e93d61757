// No fat is lost or made, whatever the plan.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "tests/property/small_runs.h"

namespace lipofill::simulation {
namespace {

RC_GTEST_PROP(Ledger, WhatIsInjectedIsInTheFilmAfterEveryStep, ()) {
  const auto simulation = start(pick_plan());
  for (int k = 0; k < 12; ++k) {
    advance(*simulation, 1);
    const StepReport& report = simulation->report();
    const double due = report.initial_volume + report.injected;
    RC_ASSERT(std::abs(report.film_volume - due) <= 1e-9 * due);
    RC_ASSERT(std::abs(report.gap_volume - due) <= 1e-4 * due);
  }
}

RC_GTEST_PROP(Ledger, ZonesAddUpToTheFilm, ()) {
  const auto simulation = start(pick_plan());
  advance(*simulation, *rc::gen::inRange(1, 12).as("steps"));
  double sum = 0.0;
  for (const ZoneReport& zone : simulation->zone_reports()) sum += zone.volume;
  RC_ASSERT(std::abs(sum - simulation->report().film_volume) <= 1e-12 * sum);
}

}  // namespace
}  // namespace lipofill::simulation
