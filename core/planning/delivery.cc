#include "core/planning/delivery.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/units.h"
#include "core/film/film_metric.h"
#include "core/plan/plan_placement.h"
#include "core/planning/cannula_fan.h"
#include "core/simulation/simulation.h"
#include "core/simulation/skin_difference.h"
#include "core/simulation/trial_shape.h"

namespace lipofill::planning {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// The entry lies so far beyond the end of its zone [m].
constexpr double kBeyond = 8e-3;
/// A tunnel has fat laid at so many places at most.
constexpr int kMostPlaces = 8;
/// Injections that a plan may have.
constexpr int kMostInjections = 1000;

/// A zone with its volume, and the rate of its first injection.
struct ZoneTask {
  std::string name;
  std::string below_layer;
  int level = 0;
  double volume = 0.0;
  double rate = 0.0;
  std::vector<ZoneCell> cells;
};

std::vector<ZoneTask> list_tasks(const model::FaceModel& model, const plan::SimulationSpec& plan,
                                 const plan::PlacedPlan& placed) {
  std::vector<ZoneTask> tasks;
  for (size_t f = 0; f < placed.films.size(); ++f) {
    const plan::FilmLayout& film = placed.films[f];
    const film::FilmMetric metric =
        film::compute_film_metric(film.grid, plan::vertices_on_skin(model.geometry.grid, film.grid));
    for (size_t z = 0; z < film.zone_names.size(); ++z) {
      ZoneTask task{film.zone_names[z],
                    plan.films[static_cast<size_t>(placed.spec_of_film[f])].below_layer,
                    film.level,
                    0.0,
                    0.0,
                    {}};
      for (const plan::InjectionSpec& injection : plan.injections) {
        if (injection.zone != task.name) continue;
        task.volume += injection.volume;
        if (task.rate == 0.0) task.rate = injection.rate;
      }
      if (task.volume == 0.0) continue;
      for (int cell = 0; cell < film.grid.n_cells(); ++cell) {
        if (!film.lies_in_zone(cell, static_cast<int>(z))) continue;
        task.cells.push_back(
            {film.cell_centre(cell), metric.centre.col(cell), metric.area[cell], Vector2d::Zero(), 0.0, 0.0});
      }
      tasks.push_back(std::move(task));
    }
  }
  std::stable_sort(tasks.begin(), tasks.end(), [](const ZoneTask& a, const ZoneTask& b) { return a.level > b.level; });
  return tasks;
}

/// A place of the chart beyond the lower end: as the chart goes on from the middle of the zone.
CannulaEntry place_entry(const model::FaceModel& model, ZoneTask& task) {
  const auto lowest = std::min_element(task.cells.begin(), task.cells.end(),
                                       [](const ZoneCell& a, const ZoneCell& b) { return a.seen.x() < b.seen.x(); });
  const auto middle = std::min_element(task.cells.begin(), task.cells.end(), [](const ZoneCell& a, const ZoneCell& b) {
    return a.seen.norm() < b.seen.norm();
  });
  const double length = std::max((lowest->seen - middle->seen).norm(), 1e-3);
  const double part = 1.0 + kBeyond / length;
  CannulaEntry entry;
  entry.zone = task.name;
  entry.below_layer = task.below_layer;
  entry.place = {std::clamp(middle->place.xi + part * (lowest->place.xi - middle->place.xi), 0.0, 1.0),
                 std::clamp(middle->place.eta + part * (lowest->place.eta - middle->place.eta), 0.0, 1.0)};
  entry.position = geometry::skin_position(model.geometry.grid, entry.place);
  entry.volume = task.volume;
  const Vector2d seen = middle->seen + part * (lowest->seen - middle->seen);
  for (ZoneCell& cell : task.cells) {
    const Vector2d away = cell.seen - seen;
    cell.radius = away.norm();
    cell.angle = std::atan2(away.y(), away.x());
  }
  return entry;
}

int count_passes(double volume, double most) {
  return std::max(1, static_cast<int>(std::ceil(volume / most - 1e-9)));
}

/// Adds the passes of one tunnel, and their injections.
void work_tunnel(const model::FaceModel& model, const ZoneTask& task, const std::vector<ZoneCell>& tunnel,
                 double volume, int n_passes, int most_places, int number, Delivery& delivery) {
  const auto places = choose_places(tunnel, most_places);
  const double area = sum_areas(tunnel);
  CannulaEntry& entry = delivery.entries.back();
  for (int k = 0; k < n_passes; ++k) {
    CannulaPass pass;
    pass.entry = static_cast<int>(delivery.entries.size()) - 1;
    pass.tunnel = number;
    pass.volume = volume / n_passes;
    pass.positions.resize(3, static_cast<Index>(places.size()) + 1);
    for (const auto& [cell, served] : places) {
      plan::InjectionSpec injection;
      injection.zone = task.name;
      injection.volume = pass.volume * served / area;
      injection.rate = task.rate;
      injection.site = cell.place;
      delivery.plan_as_given.injections.push_back(injection);
      pass.positions.col(static_cast<Index>(pass.path.size())) =
          geometry::skin_position(model.geometry.grid, cell.place);
      pass.path.push_back(cell.place);
    }
    pass.positions.rightCols(1) = entry.position;
    pass.path.push_back(entry.place);
    delivery.passes.push_back(std::move(pass));
    ++entry.passes;
  }
}

absl::Status check_tasks(const std::vector<ZoneTask>& tasks) {
  if (tasks.empty()) return absl::FailedPreconditionError("the plan injects nothing that could be laid");
  for (const ZoneTask& task : tasks) {
    if (task.volume > 0.0 && !task.cells.empty()) continue;
    return absl::FailedPreconditionError(
        absl::StrFormat("the plan takes %.2f mL out of zone '%s': there is no list for that",
                        -task.volume / kCubicMetresPerMillilitre, task.name));
  }
  return absl::OkStatus();
}

/// Runs a plan to its end.
absl::StatusOr<std::vector<simulation::FrameField>> run_plan(const std::shared_ptr<const model::FaceModel>& model,
                                                             const plan::SimulationSpec& plan,
                                                             const Unwanted& unwanted) {
  auto run = simulation::Simulation::create(model, plan);
  if (!run.ok()) return run.status();
  while ((*run)->phase() == simulation::Phase::kRunning) {
    if (const absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
    (*run)->advance_step();
  }
  if ((*run)->phase() == simulation::Phase::kFailed) return absl::FailedPreconditionError((*run)->reason());
  return (*run)->frame({"skin"});
}

}  // namespace

absl::StatusOr<Delivery> make_delivery(const model::FaceModel& model, const plan::SimulationSpec& plan,
                                       const DeliverySettings& settings) {
  plan::PlacedPlan placed;
  if (const absl::Status status = plan::place_plan(model, plan, nullptr, placed); !status.ok()) return status;
  std::vector<ZoneTask> tasks = list_tasks(model, plan, placed);
  if (const absl::Status good = check_tasks(tasks); !good.ok()) return good;
  const Vector3d up = model.is_square ? Vector3d(Vector3d::UnitY()) : model.geometry.axes.up;
  Delivery delivery;
  delivery.plan_as_given = plan;
  delivery.plan_as_given.injections.clear();
  std::vector<std::vector<std::vector<ZoneCell>>> fans;
  std::vector<CannulaEntry> entries;
  int n_passes = 0;
  for (ZoneTask& task : tasks) {
    look_from_above(up, task.cells);
    entries.push_back(place_entry(model, task));
    fans.push_back(lay_fan(task.cells, settings.tunnel_spacing));
    const double area = sum_areas(task.cells);
    for (const auto& tunnel : fans.back())
      n_passes += count_passes(task.volume * sum_areas(tunnel) / area, settings.max_pass);
  }
  if (n_passes > kMostInjections) {
    return absl::FailedPreconditionError(
        absl::StrFormat("the plan takes %d passes of at most %.3f mL, more than the %d injections that a plan may have",
                        n_passes, settings.max_pass / kCubicMetresPerMillilitre, kMostInjections));
  }
  const int most_places = std::min(kMostPlaces, kMostInjections / n_passes);
  if (most_places < kMostPlaces) {
    delivery.remarks.push_back(absl::StrFormat("fat is laid at %d places of each pass, so that %d passes are one plan",
                                               most_places, n_passes));
  }
  double duration = 0.0;
  for (size_t z = 0; z < tasks.size(); ++z) {
    const ZoneTask& task = tasks[z];
    delivery.entries.push_back(entries[z]);
    const double area = sum_areas(task.cells);
    for (size_t t = 0; t < fans[z].size(); ++t) {
      const double volume = task.volume * sum_areas(fans[z][t]) / area;
      work_tunnel(model, task, fans[z][t], volume, count_passes(volume, settings.max_pass), most_places,
                  static_cast<int>(t), delivery);
    }
    duration += task.volume / task.rate;
  }
  delivery.plan_as_given.end = std::max(plan.end, std::ceil(duration) + 1.0);
  return delivery;
}

absl::StatusOr<geometry::DistanceStatistics> compare_delivery(std::shared_ptr<const model::FaceModel> model,
                                                              const plan::SimulationSpec& plan,
                                                              const Delivery& delivery, const Unwanted& unwanted) {
  const auto planned = run_plan(model, plan, unwanted);
  if (!planned.ok()) return planned.status();
  const auto given = run_plan(model, delivery.plan_as_given, unwanted);
  if (!given.ok()) return given.status();
  std::vector<double> distances;
  for (const double square : simulation::squared_skin_distances(*planned, *given)) {
    distances.push_back(std::sqrt(square) * kMetresPerMillimetre);
  }
  return geometry::compute_distance_statistics(distances);
}

absl::StatusOr<geometry::DistanceStatistics> compare_settled(std::shared_ptr<const model::FaceModel> model,
                                                             plan::SimulationSpec plan, const Delivery& delivery,
                                                             const Unwanted& unwanted) {
  Delivery settled = delivery;
  plan.goal = settled.plan_as_given.goal = plan::TimeGoal::kSettledShape;
  // Whether a plan has to be stepped is known once it is placed.
  if (const auto trial = simulation::TrialShape::create(model, plan); !trial.ok()) return trial.status();
  return compare_delivery(std::move(model), plan, settled, unwanted);
}

}  // namespace lipofill::planning
