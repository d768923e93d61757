#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/coupling/gap_volume.h"
#include "core/simulation/simulation_impl.h"
#include "core/solid/hex_volume.h"

namespace lipofill::simulation {
namespace {

/// Sums and extremes of a film's cells.
struct FilmFigures {
  double max_pressure = -std::numeric_limits<double>::infinity();
  double min_pressure = std::numeric_limits<double>::infinity();
  double pressure_area = 0.0;
  double area = 0.0;
  double volume = 0.0;
  double max_thickness = 0.0;

  /// The pressure of a cell that fat has not entered is the pull of the tissue that holds it shut:
  /// it does not count.
  void add(const mechanics::FilmState& film, int cell, double cell_area) {
    const double cell_volume = film.volume[cell];
    if (film.is_entered.size() == 0 || film.is_entered[cell] > 0.0) {
      max_pressure = std::max(max_pressure, film.pressure[cell]);
      min_pressure = std::min(min_pressure, film.pressure[cell]);
      pressure_area += film.pressure[cell] * cell_area;
      area += cell_area;
    }
    volume += cell_volume;
    max_thickness = std::max(max_thickness, cell_volume / cell_area);
  }
  double mean_pressure() const { return area > 0.0 ? pressure_area / area : 0.0; }
};

}  // namespace

Eigen::Matrix3Xd Simulation::Impl::skin_positions() const {
  const geometry::LayeredGrid& grid = model->geometry.grid;
  if (stepper->tissue() == nullptr) return grid.nodes.leftCols(grid.nodes_per_level());
  Eigen::Matrix3Xd skin(3, grid.nodes_per_level());
  for (int s = 0; s < grid.nodes_per_level(); ++s) skin.col(s) = state.positions.col(stepper->tissue()->skin_nodes[s]);
  return skin;
}

Eigen::Matrix3Xd Simulation::Impl::skin_displacement() const {
  const geometry::LayeredGrid& grid = model->geometry.grid;
  return skin_positions() - grid.nodes.leftCols(grid.nodes_per_level());
}

/// Fills the report from an outcome that becomes the state.
void Simulation::Impl::fill_report(const step::StepOutcome& outcome, double dt) {
  const mechanics::SimulationState& next = outcome.state;
  FilmFigures figures;
  report.probe_thickness.assign(probes.size(), 0.0);
  report.probe_pressure.assign(probes.size(), 0.0);
  for (size_t f = 0; f < films.size(); ++f) {
    const Eigen::VectorXd& area = stepper->geometry().update(f, next.positions).area;
    const mechanics::FilmState& film = next.films[f];
    for (int cell = 0; cell < films[f].grid.n_cells(); ++cell) figures.add(film, cell, area[cell]);
    for (size_t k = 0; k < probes.size(); ++k) {
      if (probes[k].film != static_cast<int>(f)) continue;
      report.probe_thickness[k] = film.volume[probes[k].cell] / area[probes[k].cell];
      report.probe_pressure[k] = film.pressure[probes[k].cell];
    }
  }
  report.step = next.step;
  report.time = next.time;
  report.step_size = dt;
  report.injected = schedule.delivered();
  report.initial_volume = initial_volume;
  report.film_volume = figures.volume;
  report.gap_volume = outcome.gap.sum();
  const double scale = std::max({std::abs(report.injected), initial_volume, std::numeric_limits<double>::min()});
  report.film_volume_relative_error = std::abs(figures.volume - initial_volume - report.injected) / scale;
  double mismatch = 0.0;
  Eigen::Index offset = 0;
  for (const mechanics::FilmState& film : next.films) {
    const auto held = outcome.void_volume.segment(offset, film.volume.size());
    mismatch += (outcome.gap.segment(offset, film.volume.size()) - film.volume - held).cwiseAbs().sum();
    offset += film.volume.size();
  }
  report.gap_volume_relative_error = mismatch / std::max(figures.volume, std::numeric_limits<double>::min());
  report.max_pressure = std::isfinite(figures.max_pressure) ? figures.max_pressure : 0.0;
  report.min_pressure = std::isfinite(figures.min_pressure) ? figures.min_pressure : 0.0;
  report.mean_pressure = figures.mean_pressure();
  report.max_thickness = figures.max_thickness;
  report.void_volume = outcome.void_volume.sum();
  report.undelivered = schedule.undelivered(next.time);
  report.rejected_steps = next.rejected_steps;
  report.error_estimate = outcome.error;
  report.elastic_energy = outcome.elastic_energy;
  report.kinetic_energy = outcome.kinetic_energy;
  report.injection_work = next.injection_work;
  report.film_dissipation = next.film_dissipation;
  report.ligament_tension = outcome.spring_tension.sum();
  report.broken_ligament_points = static_cast<int>((next.spring_is_intact.array() == 0.0).count());
  report.closed_cells = 0;
  for (const mechanics::FilmState& film : next.films) {
    report.closed_cells += static_cast<int>((film.is_entered.array() == 0.0).count());
  }
  report_ligaments(outcome);
  report.film_iterations = outcome.film_iterations;
  report.newton_iterations = outcome.newton_iterations;
  report.min_scaled_jacobian = outcome.min_scaled_jacobian;
  if (stepper->tissue() == nullptr) return;
  const geometry::LayeredGrid& grid = model->geometry.grid;
  moved_skin.resize(3, grid.nodes_per_level());
  double speed = 0.0;
  for (int s = 0; s < grid.nodes_per_level(); ++s) {
    const int node = stepper->tissue()->skin_nodes[s];
    moved_skin.col(s) = next.positions.col(node);
    speed = std::max(speed, next.velocities.col(node).norm());
  }
  report.skin_speed = speed;
  report.skin_max_displacement = (moved_skin - grid.nodes.leftCols(moved_skin.cols())).colwise().norm().maxCoeff();
  report.skin_volume_change = coupling::compute_swept_volume(grid, grid.nodes, moved_skin);
}

void Simulation::Impl::report_ligaments(const step::StepOutcome& outcome) {
  ligaments.clear();
  if (stepper->tissue() == nullptr) return;
  for (const mechanics::LigamentLayout& layout : stepper->tissue()->ligaments) {
    LigamentReport ligament{layout.name, 0.0, 0.0, layout.n_springs, 0};
    for (int k = layout.first_spring; k < layout.first_spring + layout.n_springs; ++k) {
      ligament.tension += outcome.spring_tension[k];
      ligament.largest_length = std::max(ligament.largest_length, outcome.spring_length[k]);
      ligament.broken_points += outcome.state.spring_is_intact[k] == 0.0;
    }
    ligaments.push_back(std::move(ligament));
  }
}

std::vector<LigamentReport> Simulation::ligament_reports() const {
  return impl_->ligaments;
}

std::vector<LayerReport> Simulation::Impl::report_layers() const {
  std::vector<LayerReport> reports;
  if (stepper->tissue() == nullptr) return reports;
  const solid::HexMesh& mesh = stepper->tissue()->tissue.mesh();
  const auto n_layers = static_cast<int>(model->layers.size());
  const std::vector<double> at_rest = solid::compute_volumes(mesh, mesh.rest_positions, n_layers);
  const std::vector<double> now = solid::compute_volumes(mesh, state.positions, n_layers);
  for (int layer = 0; layer < n_layers; ++layer) {
    reports.push_back({model->layers[layer].name, at_rest[layer], now[layer]});
  }
  return reports;
}

std::vector<LayerReport> Simulation::layer_reports() const {
  return impl_->report_layers();
}

std::vector<ZoneReport> Simulation::zone_reports() const {
  std::vector<ZoneReport> reports;
  const Impl& impl = *impl_;
  for (size_t f = 0; f < impl.films.size(); ++f) {
    const plan::FilmLayout& layout = impl.films[f];
    const Eigen::VectorXd area = impl.stepper->geometry().metric_at(f, impl.state.positions).area;
    std::vector<FilmFigures> zones(layout.zone_names.size());
    for (int cell = 0; cell < layout.grid.n_cells(); ++cell) {
      zones[layout.grid.zone_of_cell[cell]].add(impl.state.films[f], cell, area[cell]);
    }
    for (size_t z = 0; z < zones.size(); ++z) {
      reports.push_back({layout.zone_names[z], zones[z].volume, zones[z].mean_pressure(), zones[z].max_thickness});
    }
  }
  return reports;
}

}  // namespace lipofill::simulation
