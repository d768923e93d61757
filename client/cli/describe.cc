#include "client/cli/describe.h"

#include <google/protobuf/util/time_util.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/errors.h"
#include "client/cpp/result_text.h"
#include "google/rpc/status.pb.h"

namespace lipofill::client {
namespace {

std::string time_text(const google::protobuf::Timestamp& time) {
  return google::protobuf::util::TimeUtil::ToString(time);
}

std::string statistics_line(const char* what, const v1::DistanceStatistics& statistics) {
  return absl::StrFormat("  %-24s %7.2f %7.2f %7.2f %7.2f %7.2f %7.2f %7.0f %7.0f\n", what, statistics.mean_mm(),
                         statistics.rms_mm(), statistics.median_mm(), statistics.p90_mm(), statistics.p95_mm(),
                         statistics.max_mm(), 100.0 * statistics.share_under_1_mm(),
                         100.0 * statistics.share_under_2_mm());
}

std::string volume_line(const char* what, const v1::VolumeToTarget& volume) {
  return absl::StrFormat("  %-24s %7.2f mL missing, %.2f mL too much\n", what, volume.deficit_ml(), volume.excess_ml());
}

std::string operation_state(const v1::Operation& operation) {
  if (!operation.done()) return absl::StrFormat("%3.0f %%  %s", 100.0 * operation.progress(), operation.stage());
  return operation.has_error() ? absl::StrCat("failed: ", operation.error().message()) : "done";
}

}  // namespace

std::string describe(const v1::Patient& patient) {
  std::string text = absl::StrFormat("%s\n  display name  %s\n  created       %s\n", patient.name(),
                                     patient.display_name(), time_text(patient.create_time()));
  for (const auto& [key, value] : patient.labels()) absl::StrAppend(&text, "  label         ", key, "=", value, "\n");
  return text;
}

std::string describe(const v1::Scan& scan) {
  std::string text = absl::StrFormat("%s\n  file      %s, %d bytes, %s\n  sha256    %s\n", scan.name(),
                                     v1::ScanFormat_Name(scan.format()), scan.size_bytes(),
                                     v1::ScanUnit_Name(scan.unit()), scan.sha256());
  if (!scan.complete()) return absl::StrCat(text, "  received  ", scan.received_bytes(), " bytes so far\n");
  const v1::ScanReport& report = scan.report();
  absl::StrAppendFormat(&text, "  surface   %d vertices, %d triangles, %.0f x %.0f x %.0f mm\n", report.vertices(),
                        report.triangles(), report.size_x_mm(), report.size_y_mm(), report.size_z_mm());
  absl::StrAppendFormat(&text, "  found     %d components, %d holes, %d non-manifold edges, %d degenerate triangles\n",
                        report.components(), report.boundary_loops(), report.non_manifold_edges(),
                        report.degenerate_triangles());
  return text;
}

std::string layers_text(const v1::ModelReport& report) {
  std::string text;
  for (const v1::LayerReport& layer : report.layers()) {
    absl::StrAppendFormat(&text, "  %-14s %5.2f mm thick on average, %.2f to %.2f\n", layer.name(),
                          layer.mean_thickness_mm(), layer.min_thickness_mm(), layer.max_thickness_mm());
  }
  if (report.has_bone()) {
    const v1::BoneReport& bone = report.bone();
    absl::StrAppendFormat(
        &text, "  bone %.1f mm under the skin on average, %.1f to %.1f; met at %.0f %% of the nodes\n",
        bone.mean_depth_mm(), bone.min_depth_mm(), bone.max_depth_mm(), 100.0 * bone.measured_share());
    if (bone.limited_share() > 0.0) {
      absl::StrAppendFormat(&text,
                            "  at %.0f %% of the nodes the layer ends above the bone, at its greatest thickness\n",
                            100.0 * bone.limited_share());
    }
  }
  return text;
}

std::string describe(const v1::Model& model) {
  const v1::ModelReport& report = model.report();
  std::string text = absl::StrFormat(
      "%s\n  %d hexahedra, %d nodes, worst scaled Jacobian %.3f\n  %.1f cm2 of skin over %.1f mL of tissue\n",
      model.name(), report.hexahedra(), report.nodes(), report.min_scaled_jacobian(), report.area_cm2(),
      report.tissue_volume_ml());
  if (report.scan_vertices_in_patch() > 0) {
    absl::StrAppendFormat(&text, "  %d scan vertices ride on it, at most %.2f mm from its skin\n",
                          report.scan_vertices_in_patch(), report.max_chart_deviation_mm());
  }
  for (const std::string& remark : report.scan_remarks()) absl::StrAppend(&text, "  ", remark, "\n");
  absl::StrAppend(&text, layers_text(report));
  return absl::StrCat(text, "  content   ", report.content_hash(), "\n");
}

std::string describe(const v1::Operation& operation) {
  return absl::StrFormat("%s  on %s\n  %s\n", operation.name(), operation.target(), operation_state(operation));
}

std::string describe(const v1::Evaluation& evaluation) {
  return absl::StrCat("Distance to the target, mm     mean     rms  median    90 %    95 %     max  % <1mm  % <2mm\n",
                      statistics_line("before", evaluation.before_to_target()),
                      statistics_line("simulated to target", evaluation.simulated_to_target()),
                      statistics_line("target to simulated", evaluation.target_to_simulated()),
                      absl::StrFormat("  Hausdorff distance %.2f mm, over %d points of the %s mesh\n",
                                      evaluation.hausdorff_mm(), evaluation.vertices_size(), evaluation.mesh()),
                      "Volume to the target\n", volume_line("before", evaluation.volume_before()),
                      volume_line("simulated", evaluation.volume_simulated()), kNotAMedicalDevice, "\n");
}

std::string describe(const v1::CheckPlanResponse& check) {
  std::string text = check.violations().empty() ? "The daemon takes this plan.\n" : "The daemon refuses this plan:\n";
  const auto add = [&text](const v1::PlanFinding& finding) {
    absl::StrAppend(&text, "  ", finding.field(), " ", finding.description(), "\n");
  };
  for (const v1::PlanFinding& violation : check.violations()) add(violation);
  if (!check.remarks().empty()) text += "Worth knowing:\n";
  for (const v1::PlanFinding& remark : check.remarks()) add(remark);
  for (const v1::PlacedZone& zone : check.zones()) {
    absl::StrAppendFormat(&text, "  zone %-24s %7.2f cm2 in %d cells of film %s\n", zone.name(), zone.area_cm2(),
                          zone.film_cells(), zone.film());
  }
  return text;
}

std::string list_line(const v1::Patient& patient) {
  return absl::StrFormat("%-40s %s\n", patient.name(), patient.display_name());
}

std::string list_line(const v1::Scan& scan) {
  return absl::StrFormat("%-50s %s %10d bytes  %s\n", scan.name(), v1::ScanFormat_Name(scan.format()),
                         scan.size_bytes(), scan.complete() ? "complete" : "incomplete");
}

std::string list_line(const v1::Model& model) {
  return absl::StrFormat("%-50s %7d hexahedra  %.1f cm2\n", model.name(), model.report().hexahedra(),
                         model.report().area_cm2());
}

std::string list_line(const v1::Operation& operation) {
  return absl::StrFormat("%-40s %-30s %s\n", operation.name(), operation.target(), operation_state(operation));
}

std::string list_line(const v1::Simulation& simulation) {
  return absl::StrFormat("%-40s %-8s %8.2f s %8.2f mL  %s\n", simulation.name(), state_name(simulation.state()),
                         simulation.summary().time_s(), simulation.summary().injected_ml(), simulation.display_name());
}

}  // namespace lipofill::client
