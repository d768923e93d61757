#include "core/geometry/default_size.h"

#include <algorithm>
#include <cmath>

namespace lipofill::geometry {
namespace {

constexpr int kLeastDivisions = 8;
constexpr int kMostElementsThrough = 4;
constexpr double kTallestHexahedron = 2.0;  ///< thickness over width
constexpr double kRoundOff = 1e-9;

int count_divisions(double length, double width) {
  return std::max(kLeastDivisions, 2 * static_cast<int>(std::lround(0.5 * length / width)));
}

}  // namespace

GridSize choose_grid_size(const Eigen::Vector2d& lengths, const std::vector<Footprint>& footprints) {
  double width = kDefaultWidth;
  for (const Footprint& footprint : footprints) {
    width = std::min(width, 0.25 * std::min(footprint.half_length, footprint.half_width));
  }
  width = std::max(width, kNarrowestDefaultWidth);
  width = std::max(width, std::sqrt(lengths.x() * lengths.y() / kMostDefaultQuadrilaterals));
  return {count_divisions(lengths.x(), width), count_divisions(lengths.y(), width)};
}

int choose_elements_through(double thickness, double width) {
  const int n = static_cast<int>(std::ceil(thickness / (kTallestHexahedron * width) - kRoundOff));
  return std::clamp(n, 1, kMostElementsThrough);
}

}  // namespace lipofill::geometry
