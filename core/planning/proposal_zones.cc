#include "core/planning/proposal_zones.h"

#include <algorithm>
#include <cmath>

#include "core/base/units.h"
#include "core/film/film_metric.h"
#include "core/plan/plan_placement.h"

namespace lipofill::planning {
namespace {

/// An injection that the plan does not have flows at this rate [m3/s]; the shape at rest does not
/// depend on it.
constexpr double kRate = 0.5e-6;
/// Volumes are whole multiples of it [mL].
constexpr double kResolutionMl = 1e-3;
/// A volume that rounding left below a multiple counts as that multiple [mL].
constexpr double kRoundingMl = 1e-7;

double in_ml(double volume) {
  return volume / kCubicMetresPerMillilitre;
}

/// Adds what the skin over each cell lacks to the zone of the cell.
void add_missing(const model::FaceModel& model, const std::vector<plan::FilmLayout>& films,
                 const geometry::ScalarField& deficit, std::vector<SoughtZone>& zones) {
  size_t first = 0;
  for (const plan::FilmLayout& film : films) {
    const Eigen::VectorXd area =
        film::compute_film_metric(film.grid, plan::vertices_on_skin(model.geometry.grid, film.grid)).area;
    for (int cell = 0; cell < film.grid.n_cells(); ++cell) {
      const geometry::ChartPoint centre = film.cell_centre(cell);
      const auto stacked = std::count_if(films.begin(), films.end(),
                                         [&](const plan::FilmLayout& other) { return other.cell_at(centre) >= 0; });
      const double lacking = std::max(0.0, deficit.at(centre.xi, centre.eta));
      zones[first + static_cast<size_t>(film.grid.zone_of_cell[cell])].missing +=
          area[cell] * lacking / static_cast<double>(std::max<std::ptrdiff_t>(1, stacked));
    }
    first += film.zone_names.size();
  }
}

}  // namespace

absl::StatusOr<std::vector<SoughtZone>> find_sought_zones(const model::FaceModel& model,
                                                          const plan::SimulationSpec& plan,
                                                          const geometry::ScalarField& deficit,
                                                          const ProposalBounds& bounds) {
  plan::PlacedPlan placed;
  if (const absl::Status status = plan::place_plan(model, plan, nullptr, placed); !status.ok()) return status;
  if (const absl::Status possible = check_bounds(bounds, plan, ZoneNumber::kFixed); !possible.ok()) return possible;
  std::vector<SoughtZone> zones;
  for (const plan::FilmSpec& film : plan.films) {
    for (const plan::ZoneSpec& zone : film.zones) {
      zones.push_back({zone.name, film.below_layer, 0.0, bounds.of(zone.name)});
    }
  }
  add_missing(model, placed.films, deficit, zones);
  return zones;
}

plan::SimulationSpec with_one_injection_each(plan::SimulationSpec plan) {
  std::vector<plan::InjectionSpec> injections;
  for (const plan::FilmSpec& film : plan.films) {
    for (const plan::ZoneSpec& zone : film.zones) {
      plan::InjectionSpec injection;
      injection.rate = kRate;
      const auto own = std::find_if(plan.injections.begin(), plan.injections.end(),
                                    [&](const plan::InjectionSpec& other) { return other.zone == zone.name; });
      if (own != plan.injections.end()) injection = *own;
      injection.zone = zone.name;
      injection.volume = 0.0;
      injection.start.reset();
      injections.push_back(injection);
    }
  }
  plan.injections = std::move(injections);
  plan.goal = plan::TimeGoal::kSettledShape;
  if (plan.settle_skin_speed == 0.0) plan.settle_skin_speed = plan::SimulationSpec().settle_skin_speed;
  return plan;
}

plan::SimulationSpec with_volumes(const plan::SimulationSpec& one_each, const Eigen::VectorXd& volumes) {
  plan::SimulationSpec plan = one_each;
  plan.injections.clear();
  double duration = 0.0;
  for (size_t k = 0; k < one_each.injections.size(); ++k) {
    plan::InjectionSpec injection = one_each.injections[k];
    injection.volume = volumes[static_cast<Eigen::Index>(k)];
    if (injection.volume == 0.0) continue;
    duration += std::abs(injection.volume) / injection.rate;
    plan.injections.push_back(injection);
  }
  plan.end = std::max(plan.end, std::ceil(duration) + 1.0);
  return plan;
}

Eigen::VectorXd round_volumes(const Eigen::VectorXd& volumes) {
  return volumes.unaryExpr([](double volume) {
    const double thousandths = std::floor((in_ml(volume) + kRoundingMl) / kResolutionMl);
    return thousandths / 1000.0 * kCubicMetresPerMillilitre;
  });
}

plan::SimulationSpec without_zone(plan::SimulationSpec plan, const std::string& name) {
  for (plan::FilmSpec& film : plan.films) {
    std::erase_if(film.zones, [&](const plan::ZoneSpec& zone) { return zone.name == name; });
  }
  std::erase_if(plan.films, [](const plan::FilmSpec& film) { return film.zones.empty(); });
  std::erase_if(plan.injections, [&](const plan::InjectionSpec& injection) { return injection.zone == name; });
  return plan;
}

}  // namespace lipofill::planning
