#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/mechanics/wall_fibres.h"
#include "core/model/face_model.h"
#include "core/plan/film_layout.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::equilibrium {

/// Why the settled shape of a plan cannot be found directly: the way there decides it.
struct Hindrance {
  std::string field;  ///< of lipofill.v1.SimulationSpec, for example "fat.yield_stress_pa"
  std::string why;    ///< a clause with the field as its subject
  /// The way matters while fat is injected alone: a plan that is stepped so far may be finished
  /// directly.
  bool ends_with_injection = false;

  std::string text() const { return field + " " + why; }
};

/// The first field of a plan that forbids its direct solution; nothing for a plan that has one. A
/// settled shape is the limit of the plan stepped for ever where fat flows under any pressure
/// difference, however small, and where tissue springs back the way it gave: not with a yield
/// stress, the lumped coupling, films with walls of their own, or fat that circulates through leaky
/// walls under gravity; with ligaments that may break or tissue that fat has yet to enter only once
/// all is injected.
/// Checked by tests/unit/equilibrium/scope_test.cc.
///
/// @param films      of the plan, placed
/// @param ligaments  of the plan, placed: those with a name have their breaking force from there
/// @param injected_until  the last injection ends then [s]
/// @param is_injected     it has: what hinders until then is passed over
std::optional<Hindrance> find_hindrance(const plan::SimulationSpec& spec, const model::FaceModel& model,
                                        const std::vector<plan::FilmLayout>& films,
                                        const std::vector<mechanics::LigamentLayout>& ligaments, double injected_until,
                                        bool is_injected);

}  // namespace lipofill::equilibrium
