#include "core/plan/injection_schedule.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/film/film_metric.h"

namespace lipofill::plan {
namespace {

/// Largest mean thickness of the fat in a zone: no tissue plane of the face takes more [m].
constexpr double kMaxMeanThickness = 20e-3;
/// Share of a cell's content that one step may take out of it.
constexpr double kMostTaken = 0.95;

/// Skin area over every cell of a film [m2].
Eigen::VectorXd cell_areas(const model::FaceModel& model, const film::FilmGrid& grid) {
  return film::compute_film_metric(grid, vertices_on_skin(model.geometry.grid, grid)).area;
}

/// Film and zone of a zone's name; film -1 when there is none of that name.
std::pair<int, int> find_zone(const std::vector<FilmLayout>& films, const std::string& name) {
  for (size_t f = 0; f < films.size(); ++f) {
    const auto& names = films[f].zone_names;
    const auto it = std::find(names.begin(), names.end(), name);
    if (it != names.end()) return {static_cast<int>(f), static_cast<int>(it - names.begin())};
  }
  return {-1, -1};
}

/// Spreads the volume evenly over the cells of a zone that do not touch its edge, where the tissue
/// is bonded and a cannula does not go; over all of them when every cell does.
void spread_over_zone(const FilmLayout& layout, int zone, const Eigen::VectorXd& areas, std::vector<int>& cells,
                      std::vector<double>& shares) {
  for (const bool inner_only : {true, false}) {
    if (!cells.empty()) break;
    for (int cell = 0; cell < layout.grid.n_cells(); ++cell) {
      const auto& sides = layout.grid.edge_of_side[cell];
      const bool inner = *std::min_element(sides.begin(), sides.end()) >= 0;
      if (layout.lies_in_zone(cell, zone) && (inner || !inner_only)) cells.push_back(cell);
    }
  }
  double area = 0.0;
  for (const int cell : cells) area += areas[cell];
  for (const int cell : cells) shares.push_back(areas[cell] / area);
}

}  // namespace

absl::StatusOr<PlacedInjection> InjectionSchedule::place(const model::FaceModel& model,
                                                         const std::vector<FilmLayout>& films,
                                                         const InjectionSpec& spec, double now) const {
  FieldViolations violations;
  const auto [film, zone] = find_zone(films, spec.zone);
  if (film < 0) violations.add("zone", absl::StrCat("is '", spec.zone, "', which no film has"));
  violations.check_range("rate_ml_per_s", spec.rate / kCubicMetresPerMillilitre, 1e-6, 1000.0, "mL/s");
  if (!std::isfinite(spec.volume)) violations.add("volume_ml", "is not a number");
  if (spec.start.has_value()) violations.check_range("start_s", *spec.start, now, 1e6, "s");
  if (!violations.empty()) return violations.to_status();

  PlacedInjection injection;
  injection.film = film;
  const FilmLayout& layout = films[film];
  const Eigen::VectorXd areas = cell_areas(model, layout.grid);
  double zone_area = 0.0;
  for (int cell = 0; cell < layout.grid.n_cells(); ++cell) {
    if (layout.lies_in_zone(cell, zone)) zone_area += areas[cell];
  }
  const double most = zone_area * kMaxMeanThickness;
  if (std::abs(spec.volume) > most) {
    violations.add("volume_ml", absl::StrCat("is ", spec.volume / kCubicMetresPerMillilitre, " mL, zone '", spec.zone,
                                             "' of ", zone_area * kSquareCentimetresPerSquareMetre,
                                             " cm2 holds at most ", most / kCubicMetresPerMillilitre, " mL"));
  }
  if (spec.site.has_value()) {
    const auto place = geometry::locate_in_chart(model.geometry, *spec.site);
    violations.absorb("site", place.status());
    const int cell = place.ok() ? layout.cell_at(*place) : -1;
    if (place.ok() && (cell < 0 || layout.grid.zone_of_cell[cell] != zone)) {
      violations.add("site", absl::StrCat("lies at (", place->xi, ", ", place->eta, ") of the chart, outside zone '",
                                          spec.zone, "'"));
    }
    injection.cells = {cell};
    injection.shares = {1.0};
  } else {
    spread_over_zone(layout, zone, areas, injection.cells, injection.shares);
  }
  if (!violations.empty()) return violations.to_status();

  injection.volume = spec.volume;
  injection.rate = spec.rate;
  injection.start = spec.start.value_or(std::max(now, end_));
  return injection;
}

void InjectionSchedule::add(PlacedInjection injection) {
  end_ = std::max(end_, injection.end());
  injections_.push_back(std::move(injection));
}

void InjectionSchedule::deliver(const std::vector<FilmLayout>& films,
                                absl::FunctionRef<double(int film, int cell)> held, double time, double dt,
                                std::vector<Eigen::VectorXd>& received) {
  received.resize(films.size());
  for (size_t f = 0; f < films.size(); ++f) received[f].setZero(films[f].grid.n_cells());
  for (PlacedInjection& injection : injections_) {
    const double amount = due(injection, time + dt) - injection.delivered;
    if (amount == 0.0) continue;
    Eigen::VectorXd& into = received[injection.film];
    const bool stays_full = films[injection.film].wall == FilmWallKind::kRigid;
    double given = 0.0;
    bool limited = false;
    for (size_t k = 0; k < injection.cells.size(); ++k) {
      const int cell = injection.cells[k];
      double share = injection.shares[k] * amount;
      if (share < 0.0 && !stays_full) {
        const double most = std::min(0.0, -kMostTaken * held(injection.film, cell) - into[cell]);
        limited = limited || share < most;
        share = std::max(share, most);
      }
      into[cell] += share;
      given += share;
    }
    injection.delivered += limited ? given : amount;
    delivered_ += limited ? given : amount;
  }
}

void InjectionSchedule::deliver_all(const std::vector<FilmLayout>& films, double time, double dt,
                                    std::vector<Eigen::VectorXd>& received) {
  deliver(
      films, [](int, int) { return std::numeric_limits<double>::max(); }, time, dt, received);
}

double InjectionSchedule::due(const PlacedInjection& injection, double time) {
  const double elapsed = std::max(0.0, time - injection.start);
  return std::copysign(std::min(std::abs(injection.volume), injection.rate * elapsed), injection.volume);
}

double InjectionSchedule::next_change(double time) const {
  double next = std::numeric_limits<double>::infinity();
  for (const PlacedInjection& injection : injections_) {
    for (const double change : {injection.start, injection.end()}) {
      if (change > time) next = std::min(next, change);
    }
  }
  return next;
}

double InjectionSchedule::undelivered(double time) const {
  double sum = 0.0;
  for (const PlacedInjection& injection : injections_) sum += due(injection, time) - injection.delivered;
  return sum;
}

std::vector<double> InjectionSchedule::delivered_each() const {
  std::vector<double> each;
  get_delivered(each);
  return each;
}

void InjectionSchedule::get_delivered(std::vector<double>& each) const {
  each.resize(injections_.size());
  for (size_t k = 0; k < injections_.size(); ++k) each[k] = injections_[k].delivered;
}

void InjectionSchedule::restore_delivered(const std::vector<double>& each, double total) {
  for (size_t k = 0; k < injections_.size(); ++k) injections_[k].delivered = each[k];
  delivered_ = total;
}

}  // namespace lipofill::plan
