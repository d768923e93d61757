#include "core/plan/plan_checks.h"

#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"

namespace lipofill::plan {
namespace {

constexpr size_t kMaxFilms = 8;
constexpr size_t kMaxInjections = 1000;
constexpr size_t kMaxProbes = 64;

void check_count(const char* field, size_t count, size_t most, FieldViolations& violations) {
  if (count > most) violations.add(field, absl::StrCat("are ", count, ", must be at most ", most));
}

template <typename Items>
void check_names(const char* field, const Items& items, FieldViolations& violations) {
  std::set<std::string> seen;
  for (size_t k = 0; k < items.size(); ++k) {
    const std::string at = absl::StrCat(field, "[", k, "].name");
    if (items[k].name.empty()) violations.add(at, "is empty");
    if (!seen.insert(items[k].name).second) violations.add(at, absl::StrCat("is '", items[k].name, "' a second time"));
  }
}

void check_time(const SimulationSpec& spec, FieldViolations& violations) {
  violations.check_range("time.step_ms", spec.step / kSecondsPerMillisecond, 0.001, 10000.0, "ms");
  if (spec.max_step.has_value()) {
    violations.check_range("time.max_step_ms", *spec.max_step / kSecondsPerMillisecond,
                           spec.step / kSecondsPerMillisecond, 60000.0, "ms");
  }
  if (spec.max_injection_step.has_value()) {
    violations.check_range("time.max_injection_step_ms", *spec.max_injection_step / kSecondsPerMillisecond,
                           spec.step / kSecondsPerMillisecond, 60000.0, "ms");
  }
  violations.check_range("time.error_tolerance_mm", spec.error_tolerance * kMillimetresPerMetre, 1e-9, 100.0, "mm");
  violations.check_range("time.end_s", spec.end, 1e-6, 1e6, "s");
  violations.check_range("time.settle_skin_speed_mm_per_s", spec.settle_skin_speed * kMillimetresPerMetre, 0.0, 1000.0,
                         "mm/s");
}

/// Checks the friction: without any on the walls there is no shear across the film for a yield
/// stress or a spring to act on.
void check_friction(const SimulationSpec& spec, FieldViolations& violations) {
  const bool newtonian = spec.fat_flow_index == 1.0 && spec.fat_yield_stress == 0.0;
  if (newtonian && !spec.fat_shear_modulus.has_value()) return;
  for (size_t f = 0; f < spec.films.size(); ++f) {
    if (spec.films[f].wall_friction == film::WallFriction::kNoSlip) continue;
    violations.add(absl::StrCat("films[", f, "].wall_friction"),
                   "is NONE, which is for Newtonian fat: flow index 1, no yield stress, no shear modulus");
  }
}

}  // namespace

absl::Status check_plan(const SimulationSpec& spec) {
  FieldViolations violations;
  if (spec.fat_flow_index == 1.0) {
    violations.check_range("fat.viscosity_pa_s", spec.fat_viscosity, 1e-4, 1e6, "Pa s");
  } else {
    violations.check_range("fat.consistency_pa_s_n", spec.fat_viscosity, 1e-4, 1e6, "Pa s^n");
  }
  violations.check_range("fat.density_kg_m3", spec.fat_density, 1.0, 30000.0, "kg/m3");
  violations.check_range("fat.flow_index", spec.fat_flow_index, 0.1, 1.0, "");
  violations.check_range("fat.yield_stress_pa", spec.fat_yield_stress, 0.0, 1e6, "Pa");
  if (spec.fat_shear_modulus.has_value()) {
    violations.check_range("fat.shear_modulus_pa", *spec.fat_shear_modulus, 1e-3, 1e9, "Pa");
  }
  if (spec.suction_limit.has_value()) {
    violations.check_range("suction_limit_pa", *spec.suction_limit, 0.0, 1e7, "Pa");
  }
  check_friction(spec, violations);
  check_time(spec, violations);
  violations.check_range("damping.mass_per_s", spec.damping_mass, 0.0, 1e6, "1/s");
  violations.check_range("damping.stiffness_s", spec.damping_stiffness, 0.0, 1e3, "s");
  violations.check_range("gravity_m_s2", spec.gravity.norm(), 0.0, 1000.0, "m/s2");
  if (spec.films.empty()) violations.add("films", "there are none; at least 1 is needed");
  check_count("films", spec.films.size(), kMaxFilms, violations);
  check_count("injections", spec.injections.size(), kMaxInjections, violations);
  check_count("probes", spec.probes.size(), kMaxProbes, violations);
  check_names("films", spec.films, violations);
  check_names("probes", spec.probes, violations);
  std::set<std::string> zones;
  for (size_t f = 0; f < spec.films.size(); ++f) {
    for (size_t z = 0; z < spec.films[f].zones.size(); ++z) {
      if (zones.insert(spec.films[f].zones[z].name).second) continue;
      violations.add(absl::StrCat("films[", f, "].zones[", z, "].name"),
                     absl::StrCat("is '", spec.films[f].zones[z].name, "' a second time: injections name zones"));
    }
    if (spec.films[f].wall != FilmWallKind::kRigid || !spec.films[f].initial_thickness.has_value()) continue;
    violations.add(absl::StrCat("films[", f, "].initial_thickness_mm"), "is given, must be absent when wall is RIGID");
  }
  return violations.to_status();
}

bool has_placeable_size(const SimulationSpec& spec) {
  return spec.films.size() <= kMaxFilms && spec.injections.size() <= kMaxInjections && spec.probes.size() <= kMaxProbes;
}

absl::Status check_room_for_injection(const SimulationSpec& spec) {
  if (spec.injections.size() < kMaxInjections) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("the plan has ", spec.injections.size(), " injections, the bound is ", kMaxInjections));
}

}  // namespace lipofill::plan
