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

/// Without rim, by zone, and of the face's symmetry.
std::string parts_text(const v1::Evaluation& evaluation) {
  std::string text =
      absl::StrCat("Without the rim\n", statistics_line("before", evaluation.without_rim_before().skin_to_target()),
                   statistics_line("simulated to target", evaluation.without_rim().skin_to_target()),
                   statistics_line("target to simulated", evaluation.without_rim().target_to_skin()));
  for (const v1::ZoneComparison& zone : evaluation.zones()) {
    absl::StrAppend(&text, "Zone ", zone.zone(), "\n", statistics_line("before", zone.before().skin_to_target()),
                    statistics_line("simulated to target", zone.simulated().skin_to_target()),
                    volume_line("before", zone.before().volume()), volume_line("simulated", zone.simulated().volume()));
  }
  if (!evaluation.has_symmetry()) return text;
  const v1::SymmetryIndex& symmetry = evaluation.symmetry();
  absl::StrAppendFormat(&text, "Symmetry index %.2f mm before, %.2f mm simulated", symmetry.before_mm(),
                        symmetry.simulated_mm());
  if (symmetry.has_target_mm()) absl::StrAppendFormat(&text, ", %.2f mm of the target", symmetry.target_mm());
  return text + "\n";
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

std::string surface_text(const v1::ScanReport& report) {
  std::string text;
  absl::StrAppendFormat(&text, "  surface   %d vertices, %d triangles, %.0f x %.0f x %.0f mm\n", report.vertices(),
                        report.triangles(), report.size_x_mm(), report.size_y_mm(), report.size_z_mm());
  absl::StrAppendFormat(&text, "  found     %d components, %d holes, %d non-manifold edges, %d degenerate triangles\n",
                        report.components(), report.boundary_loops(), report.non_manifold_edges(),
                        report.degenerate_triangles());
  for (const std::string& remark : report.read_remarks()) absl::StrAppend(&text, "  read      ", remark, "\n");
  for (const std::string& remark : report.mending_remarks()) absl::StrAppend(&text, "  mended    ", remark, "\n");
  return text;
}

std::string describe(const v1::Scan& scan) {
  std::string text = absl::StrFormat("%s\n  file      %s, %d bytes, %s\n  sha256    %s\n", scan.name(),
                                     v1::ScanFormat_Name(scan.format()), scan.size_bytes(),
                                     v1::ScanUnit_Name(scan.unit()), scan.sha256());
  if (!scan.complete()) return absl::StrCat(text, "  received  ", scan.received_bytes(), " bytes so far\n");
  return absl::StrCat(text, surface_text(scan.report()));
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
                      volume_line("simulated", evaluation.volume_simulated()), parts_text(evaluation),
                      kNotAMedicalDevice, "\n");
}

std::string describe(const v1::Target& target) {
  const v1::TargetReport& report = target.report();
  const v1::Registration& fit = report.registration();
  std::string text = absl::StrCat(target.scan(), "\n");
  if (report.has_plane()) {
    const v1::SymmetryPlane& plane = report.plane();
    absl::StrAppendFormat(&text,
                          "  the %s side mirrored at a plane turned by %.2f degrees and moved by %.2f mm against the "
                          "landmarks'\n  symmetry index %.2f mm\n",
                          report.mirrored_side(), plane.turned_degrees(), plane.moved_mm(), plane.symmetry_index_mm());
  } else {
    absl::StrAppendFormat(&text, "  placed from %s, known to %.2f mm, confidence %.2f\n", fit.start(),
                          fit.expected_error_mm(), fit.confidence());
  }
  absl::StrAppendFormat(&text, "  %.0f %% overlap, %.0f %% of it within 1 mm, %.2f mm in the median\n",
                        100.0 * fit.overlap(), 100.0 * fit.share_within_1_mm(), fit.median_mm());
  return text;
}

std::string describe(const v1::Deficit& deficit) {
  std::string text = "Region                       cm2    mL missing   too much   deepest mm   rms mm\n";
  const auto add = [&text](const std::string& name, const v1::RegionDeficit& region) {
    absl::StrAppendFormat(&text, "  %-22s %7.1f %13.2f %10.2f %12.2f %8.2f\n", name, region.area_cm2(),
                          region.volume().deficit_ml(), region.volume().excess_ml(), region.max_deficit_mm(),
                          region.distance().rms_mm());
  };
  add("all", deficit.all());
  for (const v1::RegionDeficit& region : deficit.regions()) add(region.region(), region);
  absl::StrAppendFormat(&text, "  Hausdorff distance %.2f mm", deficit.hausdorff_mm());
  if (deficit.has_symmetry_index_mm()) {
    absl::StrAppendFormat(&text, ", symmetry index of the face %.2f mm", deficit.symmetry_index_mm());
  }
  text += "\n";
  for (const std::string& remark : deficit.remarks()) absl::StrAppend(&text, "  ", remark, "\n");
  return absl::StrCat(text, kNotAMedicalDevice, "\n");
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
