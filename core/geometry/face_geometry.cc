#include "core/geometry/face_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/field_violations.h"
#include "core/geometry/default_size.h"
#include "core/geometry/extrusion.h"
#include "core/geometry/scan_region.h"
#include "core/geometry/skin_projection.h"
#include "core/geometry/surface_chart.h"
#include "core/geometry/surface_topology.h"

namespace lipofill::geometry {
namespace {

/// Divisions of a chart that is only there to be measured.
constexpr int kTrialDivisions = 16;
constexpr int kMinDivisions = 2;
constexpr int kMaxDivisions = 512;
constexpr int kMaxLayers = 8;
constexpr int kMaxElementsThrough = 16;
constexpr long long kMaxHexahedra = 200'000;
constexpr double kThickestLayerMm = 100.0;
constexpr double kShortestSquareMm = 1.0;
constexpr double kLongestSquareMm = 1000.0;

void check_layer(const LayerGeometry& layer, const std::string& field, FieldViolations& violations) {
  if (layer.elements_through != 0) {
    violations.check_range(field + ".elements_through", layer.elements_through, 1, kMaxElementsThrough, "");
  }
  const absl::Status shape = layer.thickness.validate();
  violations.absorb(field + ".thickness_mm", shape);
  if (!shape.ok()) return;
  const double thinnest = layer.thickness.minimum() * 1e3;
  const double thickest = layer.thickness.maximum() * 1e3;
  if (thinnest > 0.0 && thickest <= kThickestLayerMm) return;
  violations.add(field + ".thickness_mm", absl::StrCat("is ", thinnest > 0.0 ? thickest : thinnest,
                                                       " mm, must be above 0 and at most ", kThickestLayerMm));
}

/// A count that is not known yet counts as 1, or as nothing.
void check_count(const GridSize& size, const std::vector<LayerGeometry>& layers, FieldViolations& violations) {
  long long through = 0;
  for (const LayerGeometry& layer : layers) through += std::max(1, layer.elements_through);
  const long long hexahedra = through * size.n_xi * size.n_eta;
  if (hexahedra <= kMaxHexahedra) return;
  violations.add("n_xi", absl::StrCat("is ", size.n_xi, ", which with n_eta ", size.n_eta, " and ", through,
                                      " elements through the layers makes ", hexahedra, " hexahedra, must be at most ",
                                      kMaxHexahedra));
}

void check_layers(const FaceGeometrySpec& spec, FieldViolations& violations) {
  if (spec.layers.size() > kMaxLayers) {
    violations.add("layers", absl::StrCat("are ", spec.layers.size(), ", must be at most ", kMaxLayers));
    return;
  }
  for (size_t l = 0; l < spec.layers.size(); ++l) {
    check_layer(spec.layers[l], absl::StrCat("layers[", l, "]"), violations);
  }
  if (violations.empty()) check_count({spec.n_xi, spec.n_eta}, spec.layers, violations);
}

absl::Status report(const Progress& progress, double fraction, const char* stage) {
  if (!progress || progress(fraction, stage)) return absl::OkStatus();
  return absl::CancelledError("building the geometry was cancelled");
}

/// Area of the bilinear skin, by the two-point Gauss rule in each cell [m2].
double compute_skin_area(const LayeredGrid& grid) {
  const double near = 0.5 - 0.5 / std::sqrt(3.0);
  double area = 0.0;
  for (int j = 0; j < grid.n_eta; ++j) {
    for (int i = 0; i < grid.n_xi; ++i) {
      const Eigen::Vector3d a = grid.nodes.col(grid.surface_index(i, j));
      const Eigen::Vector3d b = grid.nodes.col(grid.surface_index(i + 1, j)) - a;
      const Eigen::Vector3d c = grid.nodes.col(grid.surface_index(i, j + 1)) - a;
      const Eigen::Vector3d d = grid.nodes.col(grid.surface_index(i + 1, j + 1)) - a - b - c;
      for (const double r : {near, 1.0 - near}) {
        for (const double s : {near, 1.0 - near}) area += 0.25 * (b + s * d).cross(c + r * d).norm();
      }
    }
  }
  return area;
}

/// The divisions that are asked for, and the default for those that are not.
GridSize complete_size(const FaceGeometrySpec& spec, const GridSize& by_default) {
  return {spec.n_xi > 0 ? spec.n_xi : by_default.n_xi, spec.n_eta > 0 ? spec.n_eta : by_default.n_eta};
}

/// The layers with hexahedra through all of them.
std::vector<LayerGeometry> complete_layers(std::vector<LayerGeometry> layers, const Eigen::Matrix3Xd& skin,
                                           const GridSize& size) {
  const double width = compute_mean_spacing(size.n_xi, size.n_eta, skin).mean();
  for (LayerGeometry& layer : layers) {
    if (layer.elements_through == 0) layer.elements_through = choose_elements_through(layer.thickness.mean(), width);
  }
  return layers;
}

absl::StatusOr<LayeredGrid> lay_on(const Eigen::Matrix3Xd& skin, const GridSize& size,
                                   const std::vector<LayerGeometry>& given,
                                   std::vector<Eigen::Vector3d>* folded = nullptr) {
  const std::vector<LayerGeometry> layers = complete_layers(given, skin, size);
  FieldViolations violations;
  check_count(size, layers, violations);
  if (!violations.empty()) return violations.to_status();
  return extrude_layers(skin, size.n_xi, size.n_eta, layers, folded);
}

absl::StatusOr<FaceGeometry> build_square(const SquareSpec& square, const FaceGeometrySpec& spec) {
  const GridSize size = complete_size(spec, choose_grid_size({square.length_xi, square.length_eta}, {}));
  Eigen::Matrix3Xd skin(3, (size.n_xi + 1) * (size.n_eta + 1));
  for (int j = 0; j <= size.n_eta; ++j) {
    for (int i = 0; i <= size.n_xi; ++i) {
      skin.col(j * (size.n_xi + 1) + i) =
          Eigen::Vector3d(square.length_xi * i / size.n_xi, square.length_eta * j / size.n_eta, 0.0);
    }
  }
  auto grid = lay_on(skin, size, spec.layers);
  if (!grid.ok()) return grid.status();
  FaceGeometry geometry;
  geometry.grid = std::move(*grid);
  geometry.skin_area = square.length_xi * square.length_eta;
  return geometry;
}

/// Half the mean edge of the scan in the patch: facets of that length fade from the skin, anatomy
/// does not.
double choose_smoothing_length(const SurfaceMesh& patch, const Eigen::Vector2d& spacing) {
  std::vector<double> lengths;
  for (const EdgeUse& use : sort_edge_uses(patch)) {
    lengths.push_back((patch.points.col(use.high) - patch.points.col(use.low)).norm());
  }
  std::nth_element(lengths.begin(), lengths.begin() + static_cast<long>(lengths.size() / 2), lengths.end());
  return 0.5 * std::max(lengths[lengths.size() / 2], spacing.maxCoeff());
}

/// Scan vertices over the region, with their feet on the skin.
void find_riders(const ScanRegion& region, const std::vector<bool>& is_vertex_near, FaceGeometry& geometry) {
  std::vector<bool> is_near(geometry.scan.n_vertices(), false);
  for (size_t v = 0; v < is_vertex_near.size(); ++v) {
    const int cleaned = region.patch.whole_of_vertex[v];
    if (cleaned >= 0 && is_vertex_near[v]) is_near[cleaned] = true;
  }
  const SkinProjection projection(geometry.grid);
  double squares = 0.0;
  for (int v = 0; v < geometry.scan.n_vertices(); ++v) {
    const int cleaned = region.cleaned_of_scan[v];
    if (cleaned < 0 || !is_near[cleaned]) continue;
    const SkinFoot foot = projection.project(geometry.scan.points.col(v));
    if (!(std::max(std::abs(foot.place.xi - 0.5), std::abs(foot.place.eta - 0.5)) <= 0.5)) continue;
    geometry.riders.push_back({v, foot.place});
    geometry.max_rider_distance = std::max(geometry.max_rider_distance, foot.distance);
    squares += foot.distance * foot.distance;
  }
  if (geometry.riders.empty()) return;
  geometry.rms_rider_distance = std::sqrt(squares / static_cast<double>(geometry.riders.size()));
  if (geometry.rms_rider_distance <= kRoughScan) return;
  geometry.cautions.push_back(
      absl::StrFormat("The scan is rough: its vertices lie %.2f mm (rms) off the smoothed skin, %.2f mm at most.",
                      geometry.rms_rider_distance * 1e3, geometry.max_rider_distance * 1e3));
}

/// The chart between the corners, or around the footprints with what there is to say of it.
absl::StatusOr<RegionChart> chart_scan_region(const ScanRegion& region, const GridSize& size,
                                              std::vector<std::string>& cautions) {
  if (!region.around) return chart_region(region.patch, size.n_xi, size.n_eta);
  auto around = chart_around(region.patch, *region.around, size.n_xi, size.n_eta);
  if (!around.ok()) return around.status();
  cautions.insert(cautions.end(), around->remarks.begin(), around->remarks.end());
  return std::move(around->chart);
}

/// The divisions of the region's chart; where one is not given, the chart is made once to be
/// measured.
absl::StatusOr<GridSize> find_size(const ScanRegion& region, const std::vector<Footprint>& footprints,
                                   const FaceGeometrySpec& spec) {
  if (spec.n_xi > 0 && spec.n_eta > 0) return GridSize{spec.n_xi, spec.n_eta};
  std::vector<std::string> told_later;
  const auto trial = chart_scan_region(region, {kTrialDivisions, kTrialDivisions}, told_later);
  if (!trial.ok()) return trial.status();
  const Eigen::Vector2d lengths =
      kTrialDivisions * compute_mean_spacing(kTrialDivisions, kTrialDivisions, trial->points);
  return complete_size(spec, choose_grid_size(lengths, footprints));
}

absl::StatusOr<FaceGeometry> build_scan_region(const ScanRegionSpec& scan, const FaceGeometrySpec& spec,
                                               const Progress& progress) {
  auto region = find_scan_region(scan, progress);
  if (!region.ok()) return region.status();
  if (const absl::Status go = report(progress, 0.6, "charting the skin"); !go.ok()) return go;
  const auto size = find_size(*region, scan.footprints, spec);
  if (!size.ok()) return size.status();
  auto chart = chart_scan_region(*region, *size, region->cautions);
  if (!chart.ok()) return chart.status();
  Eigen::Matrix3Xd& skin = chart->points;
  const Eigen::Vector2d spacing = compute_mean_spacing(size->n_xi, size->n_eta, skin);
  smooth_over_grid(size->n_xi, size->n_eta, spacing, choose_smoothing_length(region->patch.mesh, spacing), skin);

  if (const absl::Status go = report(progress, 0.8, "extruding the layers"); !go.ok()) return go;
  auto grid = lay_on(skin, *size, spec.layers);
  if (!grid.ok()) return grid.status();
  FaceGeometry geometry;
  geometry.grid = std::move(*grid);
  geometry.scan = scan.scan;
  geometry.axes = region->axes;
  geometry.landmarks = scan.landmarks;
  geometry.scan_remarks = region->remarks;
  geometry.cautions = region->cautions;
  geometry.skin_area = compute_skin_area(geometry.grid);
  if (const absl::Status go = report(progress, 0.9, "placing the scan on the skin"); !go.ok()) return go;
  find_riders(*region, chart->is_vertex_near, geometry);
  return geometry;
}

}  // namespace

absl::Status check_face_geometry(const FaceGeometrySpec& spec) {
  FieldViolations violations;
  if (spec.n_xi != 0) violations.check_range("n_xi", spec.n_xi, kMinDivisions, kMaxDivisions, "");
  if (spec.n_eta != 0) violations.check_range("n_eta", spec.n_eta, kMinDivisions, kMaxDivisions, "");
  if (const auto* square = std::get_if<SquareSpec>(&spec.region)) {
    violations.check_range("square.length_xi_mm", square->length_xi * 1e3, kShortestSquareMm, kLongestSquareMm, "mm");
    violations.check_range("square.length_eta_mm", square->length_eta * 1e3, kShortestSquareMm, kLongestSquareMm, "mm");
  }
  check_layers(spec, violations);
  return violations.to_status();
}

absl::Status lay_layers(const std::vector<LayerGeometry>& layers, FaceGeometry& geometry,
                        std::vector<Eigen::Vector3d>* folded) {
  FaceGeometrySpec spec;
  spec.n_xi = geometry.grid.n_xi;
  spec.n_eta = geometry.grid.n_eta;
  spec.layers = layers;
  FieldViolations violations;
  check_layers(spec, violations);
  if (!violations.empty()) return violations.to_status();
  auto grid =
      lay_on(geometry.grid.nodes.leftCols(geometry.grid.nodes_per_level()), {spec.n_xi, spec.n_eta}, layers, folded);
  if (!grid.ok()) return grid.status();
  geometry.grid = *std::move(grid);
  return absl::OkStatus();
}

absl::StatusOr<FaceGeometry> build_face_geometry(const FaceGeometrySpec& spec, const Progress& progress) {
  const absl::Status valid = check_face_geometry(spec);
  if (!valid.ok()) return valid;
  auto geometry = std::holds_alternative<SquareSpec>(spec.region)
                      ? build_square(std::get<SquareSpec>(spec.region), spec)
                      : build_scan_region(std::get<ScanRegionSpec>(spec.region), spec, progress);
  if (!geometry.ok()) return geometry;
  if (const absl::Status go = report(progress, 1.0, "done"); !go.ok()) return go;
  return geometry;
}

}  // namespace lipofill::geometry
