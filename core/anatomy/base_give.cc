#include "core/anatomy/base_give.h"

#include <algorithm>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/anatomy/regions.h"
#include "core/anatomy/smooth_step.h"
#include "core/geometry/surface_chart.h"

namespace lipofill::anatomy {
namespace {

/// The blend from all give to bone, in units of a region's half-axes.
constexpr double kAllGive = 0.7;
constexpr double kBone = 1.3;

std::vector<PlacedRegion> place_boneless_regions(const geometry::FaceGeometry& face) {
  std::vector<PlacedRegion> regions;
  for (const char* name : {"buccal", "submaxillary"}) {
    for (const char* side : {"_left", "_right"}) {
      const auto region = place_region_by_landmarks(face, absl::StrCat(name, side));
      if (region.ok()) regions.push_back(*region);
    }
  }
  return regions;
}

}  // namespace

std::optional<Eigen::VectorXd> compute_base_give(const geometry::FaceGeometry& face) {
  const std::vector<PlacedRegion> regions = place_boneless_regions(face);
  if (regions.empty()) return std::nullopt;
  const int n = face.grid.nodes_per_level();
  const Eigen::Matrix3Xd normals =
      geometry::compute_grid_normals(face.grid.n_xi, face.grid.n_eta, face.grid.nodes.leftCols(n));
  Eigen::VectorXd give = Eigen::VectorXd::Zero(n);
  for (int node = 0; node < n; ++node) {
    for (const PlacedRegion& region : regions) {
      const double radius = region.compute_radius(face.grid.nodes.col(node), normals.col(node));
      give[node] = std::max(give[node], smooth_step((kBone - radius) / (kBone - kAllGive)));
    }
  }
  return give;
}

}  // namespace lipofill::anatomy
