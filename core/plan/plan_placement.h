#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/base/unwanted.h"
#include "core/model/face_model.h"
#include "core/plan/film_layout.h"
#include "core/plan/injection_schedule.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::plan {

/// A probe's cell.
struct ProbePlace {
  int film = 0;
  int cell = 0;
};

/// A plan on a model, as far as it could be placed: whole when place_plan() returned OK.
struct PlacedPlan {
  std::vector<FilmLayout> films;
  std::vector<int> spec_of_film;  ///< index in SimulationSpec::films of each of them
  InjectionSchedule schedule;
  std::vector<ProbePlace> probes;
};

/// Checks a plan and places its films, injections and probes on a model. It goes on after what is
/// wrong, so that everything can be mended at once: only what lies in a film that has no place
/// itself is left out.
///
/// INVALID_ARGUMENT with field violations named as in lipofill.v1.SimulationSpec, CANCELLED once it
/// is unwanted.
/// Checked by tests/unit/plan/plan_placement_test.cc.
absl::Status place_plan(const model::FaceModel& model, const SimulationSpec& spec, const Unwanted& unwanted,
                        PlacedPlan& placed);

}  // namespace lipofill::plan
