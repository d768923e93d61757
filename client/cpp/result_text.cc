#include "client/cpp/result_text.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lipofill::client {
namespace {

std::string number(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return error == std::errc() ? std::string(text, end) : "nan";
}

std::string series_header(const v1::SimulationSpec& spec) {
  std::string header =
      "step,time_s,step_ms,injected_ml,film_volume_ml,gap_volume_ml,max_pressure_pa,min_pressure_pa,max_thickness_mm,"
      "skin_max_displacement_mm,skin_speed_mm_per_s";
  for (const v1::Probe& probe : spec.probes()) {
    absl::StrAppend(&header, ",probe_", probe.name(), "_thickness_mm,probe_", probe.name(), "_pressure_pa");
  }
  return header +
         ",wall_ms,rejected_steps,error_estimate_mm,void_volume_ml,elastic_energy_mj,injection_work_mj,"
         "film_dissipation_mj,ligament_tension_n,broken_ligament_points,closed_cells,cpu_ms,element_cpu_ms,"
         "factor_cpu_ms,solve_cpu_ms,film_cpu_ms,coupling_cpu_ms,factorisations,tissue_solves,film_iterations,"
         "newton_iterations,iterative_iterations,fallbacks\n";
}

void append_cost(std::string& csv, const v1::ComputingCost& cost) {
  for (double value : {cost.cpu_ms(), cost.element_cpu_ms(), cost.factor_cpu_ms(), cost.solve_cpu_ms(),
                       cost.film_cpu_ms(), cost.coupling_cpu_ms()}) {
    absl::StrAppend(&csv, ",", number(value));
  }
  for (uint64_t count : {cost.factorisations(), cost.tissue_solves(), cost.film_iterations(), cost.newton_iterations(),
                         cost.iterative_iterations(), cost.fallbacks()}) {
    absl::StrAppend(&csv, ",", count);
  }
}

nlohmann::ordered_json cost_json(const v1::ComputingCost& cost) {
  return {{"cpu_ms", cost.cpu_ms()},
          {"element_cpu_ms", cost.element_cpu_ms()},
          {"factor_cpu_ms", cost.factor_cpu_ms()},
          {"solve_cpu_ms", cost.solve_cpu_ms()},
          {"film_cpu_ms", cost.film_cpu_ms()},
          {"coupling_cpu_ms", cost.coupling_cpu_ms()},
          {"factorisations", cost.factorisations()},
          {"tissue_solves", cost.tissue_solves()},
          {"film_iterations", cost.film_iterations()},
          {"newton_iterations", cost.newton_iterations()},
          {"iterative_iterations", cost.iterative_iterations()},
          {"fallbacks", cost.fallbacks()}};
}

std::string cost_text(const v1::ComputingCost& cost) {
  return absl::StrFormat(
      "  processor    %.0f ms: tissue %.0f, factors %.0f, solves %.0f, film %.0f, coupling %.0f; %u factors, "
      "%u solves, %u fallbacks\n",
      cost.cpu_ms(), cost.element_cpu_ms(), cost.factor_cpu_ms(), cost.solve_cpu_ms(), cost.film_cpu_ms(),
      cost.coupling_cpu_ms(), cost.factorisations(), cost.tissue_solves(), cost.fallbacks());
}

std::string preview_state_name(const v1::PreviewSummary& preview) {
  return v1::PreviewSummary::State_Name(preview.state());
}

/// Returns null when the plan asks for no preview; the differences are null until they are known.
nlohmann::ordered_json preview_json(const v1::Summary& summary) {
  if (!summary.has_preview()) return nullptr;
  const v1::PreviewSummary& preview = summary.preview();
  const auto known = [](bool has, double value) { return has ? nlohmann::ordered_json(value) : nullptr; };
  return {{"state", preview_state_name(preview)},
          {"reason", preview.reason()},
          {"wall_s", preview.wall_s()},
          {"steps", preview.steps()},
          {"time_s", preview.time_s()},
          {"hexahedra", preview.hexahedra()},
          {"film_cells", preview.film_cells()},
          {"skin_max_displacement_mm", preview.skin_max_displacement_mm()},
          {"skin_volume_change_ml", preview.skin_volume_change_ml()},
          {"difference_max_mm", known(preview.has_difference_max_mm(), preview.difference_max_mm())},
          {"difference_rms_mm", known(preview.has_difference_rms_mm(), preview.difference_rms_mm())},
          {"difference_volume_ml", known(preview.has_difference_volume_ml(), preview.difference_volume_ml())}};
}

}  // namespace

std::string preview_text(const v1::PreviewSummary& preview) {
  const bool has_shape = preview.state() == v1::PreviewSummary::DONE || preview.state() == v1::PreviewSummary::OUTDATED;
  if (!has_shape) {
    return absl::StrCat(preview_state_name(preview), preview.reason().empty() ? "" : ", ", preview.reason());
  }
  std::string text =
      absl::StrFormat("skin moved %.2f mm at most, volume changed by %.2f mL; %u steps in %.2f s on %u hexahedra",
                      preview.skin_max_displacement_mm(), preview.skin_volume_change_ml(), preview.steps(),
                      preview.wall_s(), preview.hexahedra());
  if (preview.state() == v1::PreviewSummary::OUTDATED) absl::StrAppend(&text, "; outdated, ", preview.reason());
  return text;
}

std::string summary_json(const std::string& plan, const v1::Simulation& simulation) {
  const v1::Summary& summary = simulation.summary();
  nlohmann::ordered_json zones = nlohmann::ordered_json::array();
  for (const v1::ZoneSummary& zone : summary.zones()) {
    zones.push_back({{"name", zone.name()},
                     {"volume_ml", zone.volume_ml()},
                     {"mean_pressure_pa", zone.mean_pressure_pa()},
                     {"max_thickness_mm", zone.max_thickness_mm()}});
  }
  nlohmann::ordered_json ligaments = nlohmann::ordered_json::array();
  for (const v1::LigamentSummary& ligament : summary.ligaments()) {
    ligaments.push_back({{"name", ligament.name()},
                         {"tension_n", ligament.tension_n()},
                         {"largest_length_mm", ligament.largest_length_mm()},
                         {"points", ligament.points()},
                         {"broken_points", ligament.broken_points()}});
  }
  nlohmann::ordered_json settling_error;  // null while the skin's speed rises
  if (summary.has_settling_error_mm()) settling_error = summary.settling_error_mm();
  const nlohmann::ordered_json document = {
      {"plan", plan},
      {"state", state_name(simulation.state())},
      {"reason", simulation.reason()},
      {"steps", summary.steps()},
      {"time_s", summary.time_s()},
      {"wall_s", summary.wall_s()},
      {"step_ms_median", summary.step_ms_median()},
      {"hexahedra", summary.hexahedra()},
      {"film_cells", summary.film_cells()},
      {"dofs", summary.dofs()},
      {"injected_ml", summary.injected_ml()},
      {"film_volume_ml", summary.film_volume_ml()},
      {"gap_volume_ml", summary.gap_volume_ml()},
      {"film_volume_relative_error", summary.film_volume_relative_error()},
      {"gap_volume_relative_error", summary.gap_volume_relative_error()},
      {"max_pressure_pa", summary.max_pressure_pa()},
      {"min_pressure_pa", summary.min_pressure_pa()},
      {"mean_pressure_pa", summary.mean_pressure_pa()},
      {"max_thickness_mm", summary.max_thickness_mm()},
      {"skin_max_displacement_mm", summary.skin_max_displacement_mm()},
      {"skin_volume_change_ml", summary.skin_volume_change_ml()},
      {"min_scaled_jacobian", summary.min_scaled_jacobian()},
      {"state_hash", summary.state_hash()},
      {"zones", zones},
      {"rejected_steps", summary.rejected_steps()},
      {"error_estimate_mm", summary.error_estimate_mm()},
      {"settling_error_mm", settling_error},
      {"void_volume_ml", summary.void_volume_ml()},
      {"undelivered_ml", summary.undelivered_ml()},
      {"elastic_energy_mj", summary.elastic_energy_mj()},
      {"kinetic_energy_mj", summary.kinetic_energy_mj()},
      {"injection_work_mj", summary.injection_work_mj()},
      {"film_dissipation_mj", summary.film_dissipation_mj()},
      {"closed_cells", summary.closed_cells()},
      {"ligaments", ligaments},
      {"preview", preview_json(summary)},
      {"cost", cost_json(summary.cost())},
  };
  return document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string summary_text(const std::string& plan, const v1::Simulation& simulation) {
  const v1::Summary& s = simulation.summary();
  std::string text = absl::StrFormat("%s: %s", plan, state_name(simulation.state()));
  if (!simulation.reason().empty()) absl::StrAppend(&text, " (", simulation.reason(), ")");
  absl::StrAppendFormat(
      &text,
      "\n  time         %.2f s simulated in %u steps, %u taken back; %.1f s of computing, median step "
      "%.1f ms\n",
      s.time_s(), s.steps(), s.rejected_steps(), s.wall_s(), s.step_ms_median());
  if (s.has_cost()) absl::StrAppend(&text, cost_text(s.cost()));
  absl::StrAppendFormat(&text, "  model        %u hexahedra, %u film cells, %u unknowns; worst scaled Jacobian %.2f\n",
                        s.hexahedra(), s.film_cells(), s.dofs(), s.min_scaled_jacobian());
  absl::StrAppendFormat(&text,
                        "  fat          %.3f mL injected; film %.3f mL, gap %.3f mL (relative errors %.1e, %.1e)\n",
                        s.injected_ml(), s.film_volume_ml(), s.gap_volume_ml(), s.film_volume_relative_error(),
                        s.gap_volume_relative_error());
  absl::StrAppendFormat(&text, "  pressure     mean %.2f kPa, from %.2f to %.2f kPa (%.1f mmHg at most)\n",
                        s.mean_pressure_pa() / 1e3, s.min_pressure_pa() / 1e3, s.max_pressure_pa() / 1e3,
                        s.max_pressure_pa() / 133.322);
  absl::StrAppendFormat(&text, "  film         %.2f mm thick at most\n", s.max_thickness_mm());
  absl::StrAppendFormat(&text, "  skin         moved %.2f mm at most; volume changed by %.2f mL\n",
                        s.skin_max_displacement_mm(), s.skin_volume_change_ml());
  if (s.has_settling_error_mm()) {
    absl::StrAppendFormat(&text, "               %.3f mm still to go, judged by how its speed falls\n",
                          s.settling_error_mm());
  }
  if (s.undelivered_ml() < 0.0) {
    absl::StrAppendFormat(&text, "  taken out    %.3f mL less than planned: there was no more\n", -s.undelivered_ml());
  }
  if (s.void_volume_ml() > 0.0) {
    absl::StrAppendFormat(&text, "  void         %.4f mL behind the front, at the suction limit\n", s.void_volume_ml());
  }
  if (s.closed_cells() > 0) {
    absl::StrAppendFormat(&text, "  tissue       %u film cells not entered yet\n", s.closed_cells());
  }
  if (s.has_preview()) absl::StrAppend(&text, "  preview      ", preview_text(s.preview()), "\n");
  if (s.preview().has_difference_max_mm()) {
    absl::StrAppendFormat(&text, "               %.2f mm from the result at most, %.2f mm rms; %+.2f mL of volume\n",
                          s.preview().difference_max_mm(), s.preview().difference_rms_mm(),
                          s.preview().difference_volume_ml());
  }
  for (const v1::LigamentSummary& ligament : s.ligaments()) {
    absl::StrAppendFormat(&text, "  ligament %-20s %.2f N, walls %.2f mm apart, %u of %u points broken\n",
                          ligament.name(), ligament.tension_n(), ligament.largest_length_mm(), ligament.broken_points(),
                          ligament.points());
  }
  for (const v1::ZoneSummary& zone : s.zones()) {
    absl::StrAppendFormat(&text, "  zone %-24s %.2f mL, %.2f kPa mean, %.2f mm at most\n", zone.name(),
                          zone.volume_ml(), zone.mean_pressure_pa() / 1e3, zone.max_thickness_mm());
  }
  return absl::StrCat(text, kNotAMedicalDevice, "\n");
}

std::string series_csv(const v1::SimulationSpec& spec, const std::vector<v1::SeriesRow>& rows) {
  std::string csv = series_header(spec);
  for (const v1::SeriesRow& row : rows) {
    absl::StrAppend(&csv, row.step());
    for (double value : {row.time_s(), row.step_ms(), row.injected_ml(), row.film_volume_ml(), row.gap_volume_ml(),
                         row.max_pressure_pa(), row.min_pressure_pa(), row.max_thickness_mm(),
                         row.skin_max_displacement_mm(), row.skin_speed_mm_per_s()}) {
      absl::StrAppend(&csv, ",", number(value));
    }
    // A row without the probe leaves its columns empty, so that the columns after it keep their
    // place.
    for (int i = 0; i < spec.probes_size(); ++i) {
      absl::StrAppend(&csv, ",", i < row.probe_thickness_mm_size() ? number(row.probe_thickness_mm(i)) : "");
      absl::StrAppend(&csv, ",", i < row.probe_pressure_pa_size() ? number(row.probe_pressure_pa(i)) : "");
    }
    absl::StrAppend(&csv, ",", number(row.wall_ms()), ",", row.rejected_steps());
    for (double value : {row.error_estimate_mm(), row.void_volume_ml(), row.elastic_energy_mj(),
                         row.injection_work_mj(), row.film_dissipation_mj(), row.ligament_tension_n()}) {
      absl::StrAppend(&csv, ",", number(value));
    }
    absl::StrAppend(&csv, ",", row.broken_ligament_points(), ",", row.closed_cells());
    append_cost(csv, row.cost());
    csv += "\n";
  }
  return csv;
}

std::string progress_text(const v1::SeriesRow& row) {
  return absl::StrFormat("step %d  %.2f s  %.2f mL  max %.2f kPa  skin %.2f mm, %.3f mm/s", row.step(), row.time_s(),
                         row.injected_ml(), row.max_pressure_pa() / 1e3, row.skin_max_displacement_mm(),
                         row.skin_speed_mm_per_s());
}

std::string state_name(v1::Simulation::State state) {
  return v1::Simulation::State_Name(state);
}

}  // namespace lipofill::client
