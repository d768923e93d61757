#include "core/equilibrium/scope.h"

#include <cmath>

#include "absl/strings/str_cat.h"

namespace lipofill::equilibrium {
namespace {

using Found = std::optional<Hindrance>;

Found in_fat(const plan::SimulationSpec& spec) {
  if (spec.fat_yield_stress == 0.0) return {};
  return Hindrance{"fat.yield_stress_pa", absl::StrCat("is ", spec.fat_yield_stress,
                                                       " Pa: fat that yields only above it stays where it "
                                                       "came to rest on its way")};
}

Found in_film(const plan::SimulationSpec& spec, const plan::FilmLayout& film, const std::string& field) {
  if (film.wall != plan::FilmWallKind::kTissue) {
    return Hindrance{field + ".wall", "is none of tissue: its film has no equilibrium with the skin"};
  }
  if (!film.grid.leaky_walls.empty() && !spec.gravity.isZero(0.0)) {
    return Hindrance{field + ".walls", "leak while gravity pulls: fat goes on circulating through them"};
  }
  return {};
}

Found in_tissue_to_enter(const std::vector<plan::FilmLayout>& films) {
  for (size_t f = 0; f < films.size(); ++f) {
    const double entry = films[f].connective_tissue.entry_pressure;
    if (entry == 0.0) continue;
    return Hindrance{absl::StrCat("films[", f, "].connective_tissue.entry_pressure_pa"),
                     absl::StrCat("is ", entry, " Pa: which cells fat enters depends on its way"), true};
  }
  return {};
}

Found in_ligaments(const std::vector<mechanics::LigamentLayout>& ligaments) {
  for (size_t k = 0; k < ligaments.size(); ++k) {
    if (!std::isfinite(ligaments[k].breaking_force)) continue;
    return Hindrance{absl::StrCat("ligaments[", k, "].breaking_force_n"),
                     absl::StrCat("is ", ligaments[k].breaking_force, " N: whether '", ligaments[k].name,
                                  "' breaks depends on the pressure on the way"),
                     true};
  }
  return {};
}

Found in_time(const plan::SimulationSpec& spec, double injected_until) {
  if (spec.settle_skin_speed == 0.0) {
    return Hindrance{"time.settle_skin_speed_mm_per_s", "is 0: the plan runs until time.end_s, at rest or not"};
  }
  if (injected_until > spec.end) {
    return Hindrance{"time.end_s", absl::StrCat("is ", spec.end, " s and comes before the last injection ends, at ",
                                                injected_until, " s")};
  }
  return {};
}

}  // namespace

std::optional<Hindrance> find_hindrance(const plan::SimulationSpec& spec, const model::FaceModel& model,
                                        const std::vector<plan::FilmLayout>& films,
                                        const std::vector<mechanics::LigamentLayout>& ligaments, double injected_until,
                                        bool is_injected) {
  if (model.layers.empty()) return Hindrance{"model", "has no layers: no tissue comes to rest"};
  if (spec.coupling == plan::CouplingMode::kLumped) {
    return Hindrance{"coupling", "is LUMPED: it spreads the gap over the cells as the way there has it"};
  }
  if (const Found found = in_fat(spec)) return found;
  if (spec.suction_limit.has_value() && !spec.gravity.isZero(0.0)) {
    return Hindrance{"suction_limit_pa", "is given while gravity pulls: where a void opens first depends on the way"};
  }
  for (size_t f = 0; f < films.size(); ++f) {
    if (const Found found = in_film(spec, films[f], absl::StrCat("films[", f, "]"))) return found;
  }
  if (is_injected) return in_time(spec, injected_until);
  if (const Found found = in_tissue_to_enter(films)) return found;
  if (const Found found = in_ligaments(ligaments)) return found;
  return in_time(spec, injected_until);
}

}  // namespace lipofill::equilibrium
