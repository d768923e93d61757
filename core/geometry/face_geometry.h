#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/footprint.h"
#include "core/geometry/head_axes.h"
#include "core/geometry/layered_grid.h"
#include "core/geometry/scalar_field.h"
#include "core/geometry/surface_mesh.h"

namespace lipofill::geometry {

/// A place in the chart, (0, 0) the first corner of the region, (1, 1) the third.
struct ChartPoint {
  double xi = 0.0;
  double eta = 0.0;
};

/// Weighted mean of landmarks (weights divided by their sum), moved along the head's axes.
struct LandmarkPoint {
  std::map<std::string, double> weights;
  double left = 0.0;     ///< [m]
  double up = 0.0;       ///< [m]
  double forward = 0.0;  ///< [m]
};

/// A point on the outer skin, by whichever means is at hand. The last two are projected onto the
/// outer skin.
using SkinPoint = std::variant<ChartPoint, Eigen::Vector3d, LandmarkPoint>;

/// A flat rectangle in the plane z = 0, xi along +x, eta along +y, from the origin.
struct SquareSpec {
  double length_xi = 0.0;   ///< [m]
  double length_eta = 0.0;  ///< [m]
};

/// A quadrilateral region of the outer skin of a scan, between corners or around footprints.
struct ScanRegionSpec {
  SurfaceMesh scan;  ///< is as it was read: cleaning is part of building
  Landmarks landmarks;
  std::optional<HeadAxes> axes;      ///< estimated from the landmarks when absent
  std::array<SkinPoint, 4> corners;  ///< (xi, eta) = (0,0), (1,0), (1,1), (0,1); no ChartPoint
  /// In place of corners, where there are any: the region is a rectangle around them.
  std::vector<Footprint> footprints;
  double margin = 0.0;  ///< of skin around the footprints, wanted on every side [m]
  /// The margin keeps clear of these places of the skin: layers fold there [m].
  std::vector<Eigen::Vector3d> sharp_bends;
};

struct LayerGeometry {
  ScalarField thickness;     ///< [m]
  int elements_through = 1;  ///< 0: they follow from thickness and width (default_size.h)
};

struct FaceGeometrySpec {
  std::variant<SquareSpec, ScanRegionSpec> region;
  int n_xi = 0;                       ///< 0: it follows from the size of the region (default_size.h)
  int n_eta = 0;                      ///< the same
  std::vector<LayerGeometry> layers;  ///< they go from the skin inwards
};

/// A vertex of the scan that lies in the region and rides on the skin of the model: it moves by the
/// skin's displacement at its place in the chart, bilinear between the nodes of the skin.
struct Rider {
  int vertex = 0;  ///< index into FaceGeometry::scan
  ChartPoint place;
};

/// Distance of a scan's vertices from the smoothed skin above which its noise shows in results, and
/// may be to blame for hexahedra that fold [m rms].
inline constexpr double kRoughScan = 0.35e-3;

/// A region of skin, charted and extruded.
struct FaceGeometry {
  LayeredGrid grid;
  SurfaceMesh scan;           ///< is as it was given, vertex for vertex; empty for a square
  std::vector<Rider> riders;  ///< ascending in vertex
  HeadAxes axes;
  Landmarks landmarks;
  double skin_area = 0.0;                 ///< [m2]
  double max_rider_distance = 0.0;        ///< [m]  from the resampled skin
  double rms_rider_distance = 0.0;        ///< [m]
  std::vector<std::string> scan_remarks;  ///< what cleaning did, a sentence each
  /// These say what is unusual about scan, landmarks and region, a sentence each with its figure:
  /// to know before relying on it.
  std::vector<std::string> cautions;
};

/// Reports how far a build is, in [0, 1], and what it is doing. Returning false asks it to stop
/// (CANCELLED).
using Progress = std::function<bool(double fraction, const char* stage)>;

/// Cleans the scan, cuts the region, charts it, resamples it and extrudes the layers inwards.
///
/// The chart is a conformal (or harmonic) map of the patch; its grid is smooth and free of folds.
/// Only the outer skin takes part: the mouth bag and other inner surfaces of a scan are found by
/// casting rays and left out. Errors: INVALID_ARGUMENT with field violations (fields named as in
/// lipofill.v1.ModelSpec: "n_xi", "layers[1].thickness_mm", "scan_region.corners[2]",
/// "scan_region.landmarks_mm", values in the units of those names) for what the caller gave;
/// FAILED_PRECONDITION where the scan cannot be made good, saying where (scan coordinates in mm)
/// and why; CANCELLED. Nothing is thrown. Deterministic.
/// Checked by tests/unit/geometry/.
absl::StatusOr<FaceGeometry> build_face_geometry(const FaceGeometrySpec& spec, const Progress& progress);

/// Checks whatever build_face_geometry can refuse before it looks at the scan: counts, sides of a
/// square, layers.
absl::Status check_face_geometry(const FaceGeometrySpec& spec);

/// Lays layers under the skin of a geometry in place of those it has, as build_face_geometry does.
/// FAILED_PRECONDITION where they fold, and INVALID_ARGUMENT as check_layers.
/// @param folded  out, where not null: the places of the skin under which they fold [m]
absl::Status lay_layers(const std::vector<LayerGeometry>& layers, FaceGeometry& geometry,
                        std::vector<Eigen::Vector3d>* folded = nullptr);

/// The chart place of a skin point: the nearest on the skin, or for a point given by landmarks that
/// lies deeper than 10 mm the one along the outward normal. INVALID_ARGUMENT (field violation "")
/// when it names an unknown landmark, lies farther from the outer skin, or is outside the region by
/// more than 1e-6.
absl::StatusOr<ChartPoint> locate_in_chart(const FaceGeometry& geometry, const SkinPoint& point);

/// Position on the undeformed skin [m], bilinear between nodes.
Eigen::Vector3d skin_position(const LayeredGrid& grid, const ChartPoint& place);

}  // namespace lipofill::geometry
