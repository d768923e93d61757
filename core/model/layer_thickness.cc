#include "core/model/layer_thickness.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/anatomy/regional_thickness.h"
#include "core/anatomy/tissue_presets.h"
#include "core/geometry/bone_depth.h"
#include "core/geometry/gap_filling.h"
#include "core/geometry/node_values.h"

namespace lipofill::model {
namespace {

constexpr double kThinnestMm = 0.2;
constexpr double kThickestMm = 100.0;
constexpr double kLongestSmoothingMm = 50.0;

std::string field_of(size_t layer, const char* name) {
  return absl::StrCat("layers[", layer, "].", name);
}

void check_regional(const TissueLayerSpec& layer, size_t index, bool is_square, bool under_bone_layer,
                    FieldViolations& violations) {
  if (!layer.regional_thickness) return;
  const std::string field = field_of(index, "regional_thickness");
  if (layer.down_to_bone) violations.add(field, "and down_to_bone exclude each other");
  if (is_square) violations.add(field, "needs a scan_region with landmarks, the model is a square");
  if (under_bone_layer) violations.add(field, "is asked for under the layer that goes down to the bone");
  if (!layer.kind) {
    violations.add(field_of(index, "kind"), absl::StrCat("is missing, and the name '", layer.name,
                                                         "' tells none: regional_thickness goes by the kind"));
  }
}

void check_down_to_bone(const TissueLayerSpec& layer, size_t index, bool is_square, bool has_bone,
                        FieldViolations& violations) {
  if (!layer.down_to_bone) return;
  const std::string field = field_of(index, "down_to_bone");
  const double min_mm = layer.down_to_bone->min_thickness * 1e3;
  const double max_mm = layer.down_to_bone->max_thickness * 1e3;
  violations.check_range(field + ".min_thickness_mm", min_mm, kThinnestMm, kThickestMm, "mm");
  violations.check_range(field + ".max_thickness_mm", max_mm, min_mm, kThickestMm, "mm");
  violations.check_range(field + ".smoothing_mm", layer.down_to_bone->smoothing * 1e3, 0.0, kLongestSmoothingMm, "mm");
  if (is_square) violations.add(field, "needs a scan_region with a bone_scan, the model is a square");
  if (!is_square && !has_bone) violations.add(field, "needs scan_region.bone_scan, which is missing");
}

void check_gaps(const TissueLayerSpec& layer, size_t index, bool is_square, FieldViolations& violations) {
  const geometry::ScalarField& field = layer.geometry.thickness;
  if (layer.down_to_bone || !geometry::has_gaps(field)) return;
  const std::string name = field_of(index, "thickness_mm.samples");
  if (is_square) violations.add(name, "has values that are not a number, which needs a scan_region");
  if (std::all_of(field.values.begin(), field.values.end(), [](double value) { return std::isnan(value); }))
    violations.add(name, "has no value that is a number: nothing was measured");
  if (!layer.kind) {
    violations.add(field_of(index, "kind"),
                   absl::StrCat("is missing, and the name '", layer.name,
                                "' tells none: where thickness_mm is not a number the figure of the kind stands"));
  }
}

ThicknessRange range_of(const Eigen::VectorXd& values) {
  return {values.minCoeff(), values.mean(), values.maxCoeff()};
}

/// Returns the part of `depth` that the `others` leave; below the least thickness is an error.
absl::StatusOr<Eigen::VectorXd> take_rest(const geometry::LayeredGrid& grid, const Eigen::VectorXd& depth,
                                          const Eigen::VectorXd& others, size_t index, const DownToBone& bounds) {
  Eigen::VectorXd rest = depth - others;
  Eigen::Index thinnest = 0;
  if (rest.minCoeff(&thinnest) < bounds.min_thickness) {
    const Eigen::Vector3d at = grid.nodes.col(thinnest) * 1e3;
    const auto count = (rest.array() < bounds.min_thickness).count();
    return field_violation(
        field_of(index, "down_to_bone"),
        absl::StrFormat(
            "leaves %.2f mm near (%.1f, %.1f, %.1f) mm, where bone lies %.2f mm under the skin and the other "
            "layers take %.2f mm; must be at least min_thickness_mm, %.2f mm (too thin at %.1f %% of the nodes)",
            rest[thinnest] * 1e3, at.x(), at.y(), at.z(), depth[thinnest] * 1e3, others[thinnest] * 1e3,
            bounds.min_thickness * 1e3, 100.0 * static_cast<double>(count) / static_cast<double>(rest.size())));
  }
  return rest;
}

/// Gives the layer at `index` what the others leave of the distance to the bone.
absl::Status go_down_to_bone(const geometry::LayeredGrid& grid, const FaceModelSpec& spec, size_t index,
                             std::vector<Eigen::VectorXd>& thickness, LayerThickness& result) {
  const DownToBone& bounds = *spec.layers[index].down_to_bone;
  const auto measured = geometry::measure_bone_depth(grid, *spec.bone, bounds.smoothing);
  if (!measured.ok()) return measured.status();
  Eigen::VectorXd others = Eigen::VectorXd::Zero(grid.nodes_per_level());
  for (size_t l = 0; l < thickness.size(); ++l) {
    if (l != index) others += thickness[l];
  }
  BoneFinding finding;
  finding.measured_share = measured->measured_share;
  finding.depth = range_of(measured->depth);
  const auto rest = take_rest(grid, measured->depth, others, index, bounds);
  if (!rest.ok()) return rest.status();
  const Eigen::VectorXd limited = (rest->array() > bounds.max_thickness).cast<double>();
  finding.limited_share = limited.mean();
  result.off_bone = measured->missed.cwiseMax(limited);
  geometry::smooth_over_skin(grid, bounds.smoothing, result.off_bone);
  thickness[index] = rest->cwiseMin(bounds.max_thickness);
  result.fields[index] = geometry::field_of_nodes(thickness[index], grid);
  result.bone = finding;
  return absl::OkStatus();
}

/// The thickness that stands for a layer where it was not measured: of its kind in the region, or
/// of its kind alone where the landmarks that regions go by are missing.
Eigen::VectorXd stand_in(const geometry::FaceGeometry& face, anatomy::TissueKind kind, const Eigen::VectorXd& above,
                         bool* is_regional) {
  const double figure = anatomy::figures_of(anatomy::TissuePreset::kPaper, kind).thickness;
  const Eigen::VectorXd general = Eigen::VectorXd::Constant(above.size(), figure);
  const auto regional = anatomy::compute_regional_thickness(face, kind, above, general);
  *is_regional = regional.ok();
  return regional.value_or(general);
}

/// Fills what was not measured of a layer, and says how much that is.
Eigen::VectorXd fill_layer(const geometry::FaceGeometry& face, const TissueLayerSpec& layer,
                           const Eigen::VectorXd& above, LayerThickness& result) {
  Eigen::VectorXd values = geometry::sample_with_gaps(layer.geometry.thickness, face.grid);
  const Eigen::Array<bool, Eigen::Dynamic, 1> known = values.array().isFinite();
  bool is_regional = false;
  const Eigen::VectorXd general = stand_in(face, *layer.kind, above, &is_regional);
  geometry::fill_towards(face.grid, general, kMeasuredReach, values);
  const double share = known.cast<double>().mean();
  double sum = 0.0;
  for (Eigen::Index node = 0; node < values.size(); ++node) sum += known[node] ? 0.0 : values[node];
  const double mean = sum / std::max(1.0, (1.0 - share) * static_cast<double>(values.size()));
  result.remarks.push_back(absl::StrFormat(
      "The thickness of %s is measured at %.1f %% of the region; at the other %.1f %% the figure of its kind%s stands, "
      "%.1f mm on average.",
      layer.name, 100.0 * share, 100.0 * (1.0 - share), is_regional ? " and region" : "", mean * 1e3));
  return values;
}

}  // namespace

void check_thickness_requests(const FaceModelSpec& spec, FieldViolations& violations) {
  const bool is_square = std::holds_alternative<geometry::SquareSpec>(spec.region);
  bool has_bone_layer = false;
  for (size_t l = 0; l < spec.layers.size(); ++l) {
    const TissueLayerSpec& layer = spec.layers[l];
    check_regional(layer, l, is_square, has_bone_layer, violations);
    check_down_to_bone(layer, l, is_square, spec.bone.has_value(), violations);
    check_gaps(layer, l, is_square, violations);
    if (layer.down_to_bone && has_bone_layer) {
      violations.add(field_of(l, "down_to_bone"), "is asked for by a second layer, one can take what the others leave");
    }
    has_bone_layer = has_bone_layer || layer.down_to_bone.has_value();
  }
  if (spec.bone && !has_bone_layer) {
    violations.add("scan_region.bone_scan", "is given, but no layer has down_to_bone");
  }
}

absl::StatusOr<LayerThickness> find_layer_thickness(const geometry::FaceGeometry& face, const FaceModelSpec& spec) {
  const geometry::LayeredGrid& grid = face.grid;
  LayerThickness result;
  std::vector<Eigen::VectorXd> thickness;
  std::optional<size_t> bone_layer;
  Eigen::VectorXd above = Eigen::VectorXd::Zero(grid.nodes_per_level());
  for (size_t l = 0; l < spec.layers.size(); ++l) {
    const TissueLayerSpec& layer = spec.layers[l];
    result.fields.push_back(layer.geometry.thickness);
    if (!layer.down_to_bone && geometry::has_gaps(layer.geometry.thickness)) {
      thickness.push_back(fill_layer(face, layer, above, result));
      result.fields[l] = geometry::field_of_nodes(thickness[l], grid);
      above += thickness[l];
      continue;
    }
    thickness.push_back(geometry::sample_at_nodes(layer.geometry.thickness, grid));
    if (layer.down_to_bone) bone_layer = l;
    if (layer.regional_thickness) {
      auto regional = anatomy::compute_regional_thickness(face, *layer.kind, above, thickness[l]);
      if (!regional.ok()) {
        FieldViolations violations;
        violations.absorb(field_of(l, "regional_thickness"), regional.status());
        return violations.to_status();
      }
      thickness[l] = *std::move(regional);
      result.fields[l] = geometry::field_of_nodes(thickness[l], grid);
    }
    above += thickness[l];
  }
  if (bone_layer) {
    const absl::Status done = go_down_to_bone(grid, spec, *bone_layer, thickness, result);
    if (!done.ok()) return done;
  }
  for (const Eigen::VectorXd& values : thickness) result.ranges.push_back(range_of(values));
  return result;
}

}  // namespace lipofill::model
