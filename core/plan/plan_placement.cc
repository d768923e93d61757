#include "core/plan/plan_placement.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/plan/plan_checks.h"

namespace lipofill::plan {
namespace {

class Placement {
 public:
  Placement(const model::FaceModel& model, const SimulationSpec& spec, const Unwanted& unwanted, PlacedPlan& placed)
      : model_(model), spec_(spec), unwanted_(unwanted), placed_(placed) {}

  absl::Status place() {
    violations_.absorb("", check_plan(spec_));
    if (!has_placeable_size(spec_)) return violations_.to_status();
    for (const auto part : {&Placement::place_films, &Placement::place_injections, &Placement::place_probes}) {
      if (const absl::Status wanted = (this->*part)(); !wanted.ok()) return wanted;
    }
    return violations_.to_status();
  }

 private:
  absl::Status place_films() {
    for (size_t f = 0; f < spec_.films.size(); ++f) {
      if (const absl::Status wanted = check_wanted(unwanted_); !wanted.ok()) return wanted;
      auto film = place_film(model_, spec_.films[f]);
      violations_.absorb(absl::StrCat("films[", f, "]"), film.status());
      if (!film.ok()) continue;
      placed_.films.push_back(*std::move(film));
      placed_.spec_of_film.push_back(static_cast<int>(f));
    }
    return absl::OkStatus();
  }

  absl::Status place_injections() {
    for (size_t k = 0; k < spec_.injections.size(); ++k) {
      if (const absl::Status wanted = check_wanted(unwanted_); !wanted.ok()) return wanted;
      const InjectionSpec& injection = spec_.injections[k];
      if (lies_in_unplaced_film(injection)) continue;
      violations_.absorb(absl::StrCat("injections[", k, "]"),
                         placed_.schedule.add(model_, placed_.films, injection, 0.0));
    }
    return absl::OkStatus();
  }

  absl::Status place_probes() {
    for (size_t k = 0; k < spec_.probes.size(); ++k) place_probe(spec_.probes[k], absl::StrCat("probes[", k, "]"));
    return absl::OkStatus();
  }

  void place_probe(const ProbeSpec& probe, const std::string& field) {
    const auto spec =
        std::find_if(spec_.films.begin(), spec_.films.end(), [&](const FilmSpec& f) { return f.name == probe.film; });
    const int named = probe.film.empty() ? 0 : static_cast<int>(spec - spec_.films.begin());
    if (named == static_cast<int>(spec_.films.size())) {
      violations_.add(field + ".film", absl::StrCat("is '", probe.film, "', which is no film of the plan"));
      return;
    }
    const auto place = geometry::locate_in_chart(model_.geometry, probe.place);
    violations_.absorb(field + ".place", place.status());
    const int film = find_placed(named);
    if (!place.ok() || film < 0) return;
    const int cell = placed_.films[static_cast<size_t>(film)].cell_at(*place);
    if (cell < 0) {
      violations_.add(field + ".place", absl::StrCat("lies at (", place->xi, ", ", place->eta,
                                                     ") of the chart, where the film has no cell"));
    }
    placed_.probes.push_back({film, cell});
  }

  /// Index among the placed films of one of the plan; -1 when it has no place.
  int find_placed(int spec_film) const {
    const auto& all = placed_.spec_of_film;
    const auto found = std::find(all.begin(), all.end(), spec_film);
    return found == all.end() ? -1 : static_cast<int>(found - all.begin());
  }

  bool lies_in_unplaced_film(const InjectionSpec& injection) const {
    for (size_t f = 0; f < spec_.films.size(); ++f) {
      const std::vector<ZoneSpec>& zones = spec_.films[f].zones;
      const bool has_it =
          std::any_of(zones.begin(), zones.end(), [&](const ZoneSpec& zone) { return zone.name == injection.zone; });
      if (has_it) return find_placed(static_cast<int>(f)) < 0;
    }
    return false;
  }

  const model::FaceModel& model_;
  const SimulationSpec& spec_;
  const Unwanted& unwanted_;
  PlacedPlan& placed_;
  FieldViolations violations_;
};

}  // namespace

absl::Status place_plan(const model::FaceModel& model, const SimulationSpec& spec, const Unwanted& unwanted,
                        PlacedPlan& placed) {
  return Placement(model, spec, unwanted, placed).place();
}

}  // namespace lipofill::plan
