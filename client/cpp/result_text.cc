#include "client/cpp/result_text.h"

#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/message_figures.h"

namespace lipofill::client {
namespace {

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

std::string discretisation_text(const v1::DiscretisationError& error) {
  if (!error.reason().empty()) return absl::StrCat("  grid error   not known: ", error.reason(), "\n");
  if (!error.has_lift_share()) return "";
  return absl::StrFormat(
      "  grid error   lift %.1f %%, pressures %.1f %%, skin %.3f mm at 95 of 100 places (estimates)\n",
      100.0 * error.lift_share(), 100.0 * error.pressure_share(), error.skin_mm());
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
  nlohmann::ordered_json document = {
      {"plan", plan}, {"state", state_name(simulation.state())}, {"reason", simulation.reason()}};
  document.update(figures_of(simulation.summary()));
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
  if (!s.way().empty()) absl::StrAppend(&text, "               found ", s.way(), "\n");
  if (s.has_settling_error_mm() && s.way() != "directly") {
    absl::StrAppendFormat(&text, "               %.3f mm still to go, judged by how its speed falls\n",
                          s.settling_error_mm());
  }
  absl::StrAppend(&text, discretisation_text(s.discretisation_error()));
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
  for (const v1::LayerSummary& layer : s.layers()) {
    absl::StrAppendFormat(&text, "  layer %-23s %.3f mL, %+.3f mL since rest (%+.2f %%)\n", layer.name(),
                          layer.volume_ml(), layer.volume_ml() - layer.rest_volume_ml(),
                          100.0 * (layer.volume_ml() / layer.rest_volume_ml() - 1.0));
  }
  for (const v1::ZoneSummary& zone : s.zones()) {
    absl::StrAppendFormat(&text, "  zone %-24s %.2f mL, %.2f kPa mean, %.2f mm at most\n", zone.name(),
                          zone.volume_ml(), zone.mean_pressure_pa() / 1e3, zone.max_thickness_mm());
  }
  for (const std::string& remark : s.remarks()) absl::StrAppend(&text, "  remark       ", remark, "\n");
  return absl::StrCat(text, kNotAMedicalDevice, "\n");
}

std::string series_csv(const v1::SimulationSpec& spec, const std::vector<v1::SeriesRow>& rows) {
  const std::vector<SeriesColumn> columns = columns_of_series(spec);
  const auto add_line = [&columns](std::string& csv, const auto& text_of) {
    for (const SeriesColumn& column : columns) absl::StrAppend(&csv, text_of(column), ",");
    csv.back() = '\n';
  };
  std::string csv;
  add_line(csv, [](const SeriesColumn& column) { return column.name; });
  // A row without the probe leaves its columns empty, so that the columns after it stay in their
  // place.
  for (const v1::SeriesRow& row : rows) {
    add_line(csv, [&row](const SeriesColumn& column) { return value_text(row, column); });
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
