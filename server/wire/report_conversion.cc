#include "server/wire/report_conversion.h"

#include <cmath>

#include "core/base/units.h"
#include "core/geometry/grid_volume.h"

namespace lipofill::server {
namespace {

void add_layers(const model::FaceModel& model, v1::ModelReport& report) {
  for (size_t l = 0; l < model.layers.size(); ++l) {
    v1::LayerReport& layer = *report.add_layers();
    layer.set_name(model.layers[l].name);
    layer.set_min_thickness_mm(model.thickness[l].min * kMillimetresPerMetre);
    layer.set_mean_thickness_mm(model.thickness[l].mean * kMillimetresPerMetre);
    layer.set_max_thickness_mm(model.thickness[l].max * kMillimetresPerMetre);
  }
}

v1::BoneReport to_bone_report(const model::BoneFinding& bone) {
  v1::BoneReport report;
  report.set_measured_share(bone.measured_share);
  report.set_limited_share(bone.limited_share);
  report.set_min_depth_mm(bone.depth.min * kMillimetresPerMetre);
  report.set_mean_depth_mm(bone.depth.mean * kMillimetresPerMetre);
  report.set_max_depth_mm(bone.depth.max * kMillimetresPerMetre);
  return report;
}

v1::PreviewSummary::State to_preview_state(PreviewState state) {
  switch (state) {
    case PreviewState::kPending:
      return v1::PreviewSummary::PENDING;
    case PreviewState::kRunning:
      return v1::PreviewSummary::RUNNING;
    case PreviewState::kDone:
      return v1::PreviewSummary::DONE;
    case PreviewState::kFailed:
      return v1::PreviewSummary::FAILED;
    case PreviewState::kOutdated:
      return v1::PreviewSummary::OUTDATED;
  }
  return v1::PreviewSummary::STATE_UNSPECIFIED;
}

v1::PreviewSummary to_preview_summary(const PreviewView& view) {
  v1::PreviewSummary summary;
  summary.set_state(to_preview_state(view.state));
  summary.set_reason(view.reason);
  summary.set_wall_s(view.wall_s);
  summary.set_steps(view.report.step);
  summary.set_time_s(view.report.time);
  summary.set_hexahedra(static_cast<uint32_t>(view.n_hexahedra));
  summary.set_film_cells(static_cast<uint32_t>(view.n_film_cells));
  summary.set_skin_max_displacement_mm(view.report.skin_max_displacement * kMillimetresPerMetre);
  summary.set_skin_volume_change_ml(view.report.skin_volume_change * kMillilitresPerCubicMetre);
  if (!view.difference) return summary;
  summary.set_difference_max_mm(view.difference->max * kMillimetresPerMetre);
  summary.set_difference_rms_mm(view.difference->rms * kMillimetresPerMetre);
  summary.set_difference_volume_ml(view.difference->volume * kMillilitresPerCubicMetre);
  return summary;
}

void add_discretisation(const absl::StatusOr<simulation::DiscretisationError>& error, v1::Summary& summary) {
  v1::DiscretisationError& message = *summary.mutable_discretisation_error();
  if (!error.ok()) {
    message.set_reason(std::string(error.status().message()));
    return;
  }
  message.set_lift_share(error->lift);
  message.set_pressure_share(error->pressure);
  message.set_skin_mm(error->skin * kMillimetresPerMetre);
  if (const std::string remark = simulation::remark_on(*error); !remark.empty()) summary.add_remarks(remark);
}

}  // namespace

v1::ModelReport to_model_report(const model::FaceModel& model) {
  const geometry::FaceGeometry& face = model.geometry;
  v1::ModelReport report;
  report.set_content_hash(model.content_hash);
  report.set_hexahedra(static_cast<uint32_t>(face.grid.n_hexahedra()));
  report.set_nodes(static_cast<uint32_t>(face.grid.nodes.cols()));
  report.set_min_scaled_jacobian(face.grid.min_scaled_jacobian);
  report.set_area_cm2(face.skin_area * kSquareCentimetresPerSquareMetre);
  report.set_tissue_volume_ml(geometry::compute_grid_volume(face.grid) * kMillilitresPerCubicMetre);
  report.set_scan_vertices_in_patch(static_cast<uint32_t>(face.riders.size()));
  report.set_max_chart_deviation_mm(face.max_rider_distance * kMillimetresPerMetre);
  for (const std::string& remark : face.scan_remarks) report.add_scan_remarks(remark);
  for (const std::string& caution : face.cautions) report.add_scan_remarks(caution);
  add_layers(model, report);
  if (model.bone) *report.mutable_bone() = to_bone_report(*model.bone);
  return report;
}

v1::ModelSpec with_chosen_sizes(v1::ModelSpec spec, const model::FaceModel& model) {
  spec.set_n_xi(static_cast<uint32_t>(model.geometry.grid.n_xi));
  spec.set_n_eta(static_cast<uint32_t>(model.geometry.grid.n_eta));
  for (int l = 0; l < spec.layers_size(); ++l) {
    spec.mutable_layers(l)->set_elements_through(
        static_cast<uint32_t>(model.layers[static_cast<size_t>(l)].geometry.elements_through));
  }
  return spec;
}

v1::ScanReport to_scan_report(const geometry::SurfaceMesh& mesh, const geometry::SurfaceCheck& check) {
  v1::ScanReport report;
  report.set_vertices(static_cast<uint32_t>(mesh.n_vertices()));
  report.set_triangles(static_cast<uint32_t>(mesh.n_triangles()));
  report.set_components(static_cast<uint32_t>(check.components));
  report.set_boundary_loops(static_cast<uint32_t>(check.boundary_loops));
  report.set_non_manifold_edges(static_cast<uint32_t>(check.non_manifold_edges));
  report.set_degenerate_triangles(static_cast<uint32_t>(check.degenerate_triangles));
  report.set_size_x_mm(check.extent.x() * kMillimetresPerMetre);
  report.set_size_y_mm(check.extent.y() * kMillimetresPerMetre);
  report.set_size_z_mm(check.extent.z() * kMillimetresPerMetre);
  return report;
}

v1::ComputingCost to_computing_cost(const mechanics::CostSum& sum) {
  v1::ComputingCost cost;
  cost.set_cpu_ms(sum.times.total * kMillisecondsPerSecond);
  cost.set_element_cpu_ms(sum.times.element * kMillisecondsPerSecond);
  cost.set_factor_cpu_ms(sum.times.factor * kMillisecondsPerSecond);
  cost.set_solve_cpu_ms(sum.times.solve * kMillisecondsPerSecond);
  cost.set_film_cpu_ms(sum.times.film * kMillisecondsPerSecond);
  cost.set_coupling_cpu_ms(sum.times.coupling * kMillisecondsPerSecond);
  cost.set_factorisations(sum.factorisations);
  cost.set_tissue_solves(sum.tissue_solves);
  cost.set_film_iterations(sum.film_iterations);
  cost.set_newton_iterations(sum.newton_iterations);
  cost.set_iterative_iterations(sum.iterative_iterations);
  cost.set_fallbacks(sum.fallbacks);
  return cost;
}

v1::Summary to_summary(const SessionView& view) {
  const simulation::StepReport& step = view.report;
  v1::Summary summary;
  summary.set_steps(step.step);
  summary.set_time_s(step.time);
  summary.set_wall_s(view.wall_s);
  summary.set_step_ms_median(view.step_ms_median);
  summary.set_hexahedra(static_cast<uint32_t>(view.n_hexahedra));
  summary.set_film_cells(static_cast<uint32_t>(view.n_film_cells));
  summary.set_dofs(static_cast<uint32_t>(view.n_dofs));
  summary.set_injected_ml(step.injected * kMillilitresPerCubicMetre);
  summary.set_film_volume_ml(step.film_volume * kMillilitresPerCubicMetre);
  summary.set_gap_volume_ml(step.gap_volume * kMillilitresPerCubicMetre);
  summary.set_film_volume_relative_error(step.film_volume_relative_error);
  summary.set_gap_volume_relative_error(step.gap_volume_relative_error);
  summary.set_max_pressure_pa(step.max_pressure);
  summary.set_min_pressure_pa(step.min_pressure);
  summary.set_mean_pressure_pa(step.mean_pressure);
  summary.set_max_thickness_mm(step.max_thickness * kMillimetresPerMetre);
  summary.set_skin_max_displacement_mm(step.skin_max_displacement * kMillimetresPerMetre);
  summary.set_skin_volume_change_ml(step.skin_volume_change * kMillilitresPerCubicMetre);
  summary.set_min_scaled_jacobian(step.min_scaled_jacobian);
  summary.set_state_hash(view.state_hash);
  summary.set_rejected_steps(step.rejected_steps);
  summary.set_error_estimate_mm(step.error_estimate * kMillimetresPerMetre);
  if (std::isfinite(step.settling_error)) summary.set_settling_error_mm(step.settling_error * kMillimetresPerMetre);
  summary.set_void_volume_ml(step.void_volume * kMillilitresPerCubicMetre);
  summary.set_undelivered_ml(step.undelivered * kMillilitresPerCubicMetre);
  summary.set_elastic_energy_mj(step.elastic_energy * kMillijoulesPerJoule);
  summary.set_kinetic_energy_mj(step.kinetic_energy * kMillijoulesPerJoule);
  summary.set_injection_work_mj(step.injection_work * kMillijoulesPerJoule);
  summary.set_film_dissipation_mj(step.film_dissipation * kMillijoulesPerJoule);
  summary.set_closed_cells(static_cast<uint32_t>(step.closed_cells));
  if (view.preview) *summary.mutable_preview() = to_preview_summary(*view.preview);
  *summary.mutable_cost() = to_computing_cost(view.cost);
  for (const simulation::LigamentReport& report : view.ligaments) {
    v1::LigamentSummary* ligament = summary.add_ligaments();
    ligament->set_name(report.name);
    ligament->set_tension_n(report.tension);
    ligament->set_largest_length_mm(report.largest_length * kMillimetresPerMetre);
    ligament->set_points(static_cast<uint32_t>(report.points));
    ligament->set_broken_points(static_cast<uint32_t>(report.broken_points));
  }
  for (const simulation::LayerReport& report : view.layers) {
    v1::LayerSummary* layer = summary.add_layers();
    layer->set_name(report.name);
    layer->set_rest_volume_ml(report.rest_volume * kMillilitresPerCubicMetre);
    layer->set_volume_ml(report.volume * kMillilitresPerCubicMetre);
  }
  for (const simulation::ZoneReport& report : view.zones) {
    v1::ZoneSummary* zone = summary.add_zones();
    zone->set_name(report.name);
    zone->set_volume_ml(report.volume * kMillilitresPerCubicMetre);
    zone->set_mean_pressure_pa(report.mean_pressure);
    zone->set_max_thickness_mm(report.max_thickness * kMillimetresPerMetre);
  }
  for (const std::string& remark : view.remarks) summary.add_remarks(remark);
  if (view.discretisation) add_discretisation(*view.discretisation, summary);
  summary.set_way(step.way);
  return summary;
}

v1::SeriesRow to_series_row(const SeriesEntry& entry) {
  const simulation::StepReport& step = entry.report;
  v1::SeriesRow row;
  row.set_step(step.step);
  row.set_time_s(step.time);
  row.set_step_ms(step.step_size * kMillisecondsPerSecond);
  row.set_injected_ml(step.injected * kMillilitresPerCubicMetre);
  row.set_film_volume_ml(step.film_volume * kMillilitresPerCubicMetre);
  row.set_gap_volume_ml(step.gap_volume * kMillilitresPerCubicMetre);
  row.set_max_pressure_pa(step.max_pressure);
  row.set_min_pressure_pa(step.min_pressure);
  row.set_max_thickness_mm(step.max_thickness * kMillimetresPerMetre);
  row.set_skin_max_displacement_mm(step.skin_max_displacement * kMillimetresPerMetre);
  row.set_skin_speed_mm_per_s(step.skin_speed * kMillimetresPerMetre);
  for (const double thickness : step.probe_thickness) row.add_probe_thickness_mm(thickness * kMillimetresPerMetre);
  for (const double pressure : step.probe_pressure) row.add_probe_pressure_pa(pressure);
  row.set_wall_ms(entry.wall_ms);
  row.set_rejected_steps(step.rejected_steps);
  row.set_error_estimate_mm(step.error_estimate * kMillimetresPerMetre);
  row.set_void_volume_ml(step.void_volume * kMillilitresPerCubicMetre);
  row.set_elastic_energy_mj(step.elastic_energy * kMillijoulesPerJoule);
  row.set_injection_work_mj(step.injection_work * kMillijoulesPerJoule);
  row.set_film_dissipation_mj(step.film_dissipation * kMillijoulesPerJoule);
  row.set_ligament_tension_n(step.ligament_tension);
  row.set_broken_ligament_points(static_cast<uint32_t>(step.broken_ligament_points));
  row.set_closed_cells(static_cast<uint32_t>(step.closed_cells));
  mechanics::CostSum cost;
  cost.add(step.cost);
  *row.mutable_cost() = to_computing_cost(cost);
  return row;
}

v1::DistanceStatistics to_distance_statistics(const geometry::DistanceStatistics& statistics) {
  v1::DistanceStatistics message;
  message.set_mean_mm(statistics.mean * kMillimetresPerMetre);
  message.set_rms_mm(statistics.rms * kMillimetresPerMetre);
  message.set_p95_mm(statistics.p95 * kMillimetresPerMetre);
  message.set_max_mm(statistics.max * kMillimetresPerMetre);
  message.set_median_mm(statistics.median * kMillimetresPerMetre);
  message.set_p90_mm(statistics.p90 * kMillimetresPerMetre);
  message.set_share_under_1_mm(statistics.share_under_1_mm);
  message.set_share_under_2_mm(statistics.share_under_2_mm);
  return message;
}

v1::Simulation::State to_state(SimulationState state) {
  switch (state) {
    case SimulationState::kReady:
      return v1::Simulation::READY;
    case SimulationState::kRunning:
      return v1::Simulation::RUNNING;
    case SimulationState::kPaused:
      return v1::Simulation::PAUSED;
    case SimulationState::kSettled:
      return v1::Simulation::SETTLED;
    case SimulationState::kFinished:
      return v1::Simulation::FINISHED;
    case SimulationState::kStopped:
      return v1::Simulation::STOPPED;
    case SimulationState::kFailed:
      return v1::Simulation::FAILED;
  }
  return v1::Simulation::STATE_UNSPECIFIED;
}

}  // namespace lipofill::server
