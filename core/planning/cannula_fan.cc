#include "core/planning/cannula_fan.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace lipofill::planning {

using Eigen::Vector3d;

void look_from_above(const Vector3d& up, std::vector<ZoneCell>& cells) {
  Vector3d centre = Vector3d::Zero();
  double area = 0.0;
  for (const ZoneCell& cell : cells) {
    centre += cell.area * cell.position;
    area += cell.area;
  }
  centre /= area;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const ZoneCell& cell : cells) {
    const Vector3d away = cell.position - centre;
    spread += cell.area * away * away.transpose();
  }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  Vector3d along = axes.col(2), across = axes.col(1);
  // Eigenvectors have no sign of their own.
  if (along.dot(up) < 0.0 || (along.dot(up) == 0.0 && along.sum() < 0.0)) along = -along;
  if (across.sum() < 0.0) across = -across;
  for (ZoneCell& cell : cells) {
    cell.seen = {along.dot(cell.position - centre), across.dot(cell.position - centre)};
  }
}

std::vector<std::vector<ZoneCell>> lay_fan(const std::vector<ZoneCell>& cells, double spacing) {
  double low = cells.front().angle, high = low, farthest = 0.0;
  for (const ZoneCell& cell : cells) {
    low = std::min(low, cell.angle);
    high = std::max(high, cell.angle);
    farthest = std::max(farthest, cell.radius);
  }
  const int n = std::max(1, static_cast<int>(std::ceil((high - low) * farthest / spacing)));
  std::vector<std::vector<ZoneCell>> tunnels(static_cast<size_t>(n));
  for (const ZoneCell& cell : cells) {
    const double share = high > low ? (cell.angle - low) / (high - low) : 0.0;
    tunnels[static_cast<size_t>(std::min(n - 1, static_cast<int>(share * n)))].push_back(cell);
  }
  std::erase_if(tunnels, [](const std::vector<ZoneCell>& tunnel) { return tunnel.empty(); });
  for (std::vector<ZoneCell>& tunnel : tunnels) {
    std::stable_sort(tunnel.begin(), tunnel.end(),
                     [](const ZoneCell& a, const ZoneCell& b) { return a.radius > b.radius; });
  }
  return tunnels;
}

std::vector<std::pair<ZoneCell, double>> choose_places(const std::vector<ZoneCell>& tunnel, int most) {
  const size_t n = std::min(tunnel.size(), static_cast<size_t>(most));
  std::vector<std::pair<ZoneCell, double>> places;
  for (size_t k = 0; k < n; ++k) {
    const size_t first = k * tunnel.size() / n, last = (k + 1) * tunnel.size() / n;
    double area = 0.0;
    for (size_t cell = first; cell < last; ++cell) area += tunnel[cell].area;
    places.emplace_back(tunnel[(first + last - 1) / 2], area);
  }
  return places;
}

double sum_areas(const std::vector<ZoneCell>& cells) {
  return std::accumulate(cells.begin(), cells.end(), 0.0,
                         [](double sum, const ZoneCell& cell) { return sum + cell.area; });
}

}  // namespace lipofill::planning
