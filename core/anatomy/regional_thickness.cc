#include "core/anatomy/regional_thickness.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/anatomy/regions.h"
#include "core/anatomy/smooth_step.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "core/geometry/surface_chart.h"

namespace lipofill::anatomy {
namespace {

constexpr double kThinnest = 0.2e-3;  // [m]
/// The blend ends at this multiple of a region's half-axes.
constexpr double kReach = 1.5;

struct RegionalFigure {
  TissueKind kind;
  const char* region;  ///< without its side
  double depth;        ///< [m]
  bool from_skin;      ///< the depth is that of the layer's deep face under the skin, else the layer's own thickness
};

constexpr std::array<RegionalFigure, 5> kFigures = {{
    {TissueKind::kSkin, "masseter", 1.8 * kMetresPerMillimetre, false},
    {TissueKind::kSkin, "buccal", 1.8 * kMetresPerMillimetre, false},
    {TissueKind::kSubcutaneous, "masseter", 4.25 * kMetresPerMillimetre, true},
    {TissueKind::kSubcutaneous, "buccal", 4.82 * kMetresPerMillimetre, true},
    {TissueKind::kMuscle, "masseter", 10.0 * kMetresPerMillimetre, false},
}};

struct PlacedFigure {
  PlacedRegion region;
  const RegionalFigure* figure;
};

/// The figures of a kind in the regions of both sides, as far as their landmarks are there.
absl::StatusOr<std::vector<PlacedFigure>> place_figures(const geometry::FaceGeometry& face, TissueKind kind) {
  std::vector<PlacedFigure> placed;
  absl::Status missing;
  for (const RegionalFigure& figure : kFigures) {
    if (figure.kind != kind) continue;
    for (const char* side : {"_left", "_right"}) {
      const auto region = place_region_by_landmarks(face, absl::StrCat(figure.region, side));
      if (region.ok()) {
        placed.push_back({*region, &figure});
      } else {
        missing.Update(region.status());
      }
    }
  }
  if (!placed.empty()) return placed;
  if (!missing.ok()) {
    return field_violation("",
                           "needs a scan with the landmarks zygion, gonion and cheilion of a side, _left or _right");
  }
  return field_violation("", absl::StrCat("is asked for ", std::string(name_of(kind)),
                                          ", which has no regional figure; skin, subcutaneous and muscle have"));
}

}  // namespace

absl::StatusOr<Eigen::VectorXd> compute_regional_thickness(const geometry::FaceGeometry& face, TissueKind kind,
                                                           const Eigen::VectorXd& above,
                                                           const Eigen::VectorXd& general) {
  const auto figures = place_figures(face, kind);
  if (!figures.ok()) return figures.status();
  const int n = face.grid.nodes_per_level();
  const Eigen::Matrix3Xd normals =
      geometry::compute_grid_normals(face.grid.n_xi, face.grid.n_eta, face.grid.nodes.leftCols(n));
  Eigen::VectorXd thickness(n);
  for (int node = 0; node < n; ++node) {
    const Eigen::Vector3d position = face.grid.nodes.col(node);
    double weights = 0.0;
    double sum = 0.0;
    for (const auto& [region, figure] : *figures) {
      const double weight = smooth_step((kReach - region.compute_radius(position, normals.col(node))) / (kReach - 1.0));
      if (weight == 0.0) continue;
      const double published = figure->depth - (figure->from_skin ? above[node] : 0.0);
      if (published < kThinnest) {
        return field_violation(
            "",
            absl::StrFormat("leaves %.2f mm in the %s region near (%.1f, %.1f, %.1f) mm, where the layers above take "
                            "%.2f of the %.2f mm from skin to superficial fascia; must be at least %.1f mm",
                            published * 1e3, figure->region, position.x() * 1e3, position.y() * 1e3, position.z() * 1e3,
                            above[node] * 1e3, figure->depth * 1e3, kThinnest * 1e3));
      }
      weights += weight;
      sum += weight * published;
    }
    thickness[node] = (sum + (1.0 - std::min(1.0, weights)) * general[node]) / std::max(1.0, weights);
  }
  return thickness;
}

}  // namespace lipofill::anatomy
