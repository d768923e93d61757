#include "core/export/wall_pressure.h"

#include <algorithm>
#include <cmath>

namespace lipofill::exporting {
namespace {

/// An interval of a grid line's quadrilaterals and the share of it that a cell covers.
struct Share {
  int index = 0;
  double share = 0.0;
};

/// Shares below this are round-off of borders that coincide.
constexpr double kSliver = 1e-9;

std::vector<Share> cover(double low, double high, int n) {
  std::vector<Share> shares;
  const int last = std::min(n - 1, static_cast<int>(std::floor(high * n)));
  for (int k = std::max(0, static_cast<int>(std::floor(low * n))); k <= last; ++k) {
    const double share = std::min(high * n, k + 1.0) - std::max(low * n, static_cast<double>(k));
    if (share > kSliver) shares.push_back({k, share});
  }
  return shares;
}

}  // namespace

std::vector<WallPressure> spread_over_wall(const geometry::LayeredGrid& tissue, const film::FilmGrid& film,
                                           const Eigen::VectorXd& pressure) {
  const int n_quads = tissue.n_xi * tissue.n_eta;
  std::vector<double> sum(n_quads, 0.0);
  std::vector<bool> covered(n_quads, false);
  for (int cell = 0; cell < film.n_cells(); ++cell) {
    const int i = film.slot_i(film.slot_of_cell[cell]);
    const int j = film.slot_j(film.slot_of_cell[cell]);
    for (const Share& along_eta : cover(film.vertex_eta(j), film.vertex_eta(j + 1), tissue.n_eta)) {
      for (const Share& along_xi : cover(film.vertex_xi(i), film.vertex_xi(i + 1), tissue.n_xi)) {
        const int quad = along_eta.index * tissue.n_xi + along_xi.index;
        sum[quad] += along_xi.share * along_eta.share * pressure[cell];
        covered[quad] = true;
      }
    }
  }
  std::vector<WallPressure> walls;
  for (int quad = 0; quad < n_quads; ++quad) {
    if (covered[quad]) walls.push_back({quad % tissue.n_xi, quad / tissue.n_xi, sum[quad]});
  }
  return walls;
}

}  // namespace lipofill::exporting
