#include "core/export/wall_pressure.h"

#include <numeric>

namespace lipofill::exporting {
std::vector<WallPressure> spread_over_wall(const geometry::LayeredGrid& tissue,
                                           const std::vector<film::CellPiece>& pieces,
                                           const Eigen::VectorXd& pressure) {
  const int n_quads = tissue.n_xi * tissue.n_eta;
  std::vector<double> sum(n_quads, 0.0);
  std::vector<bool> covered(n_quads, false);
  for (const film::CellPiece& piece : pieces) {
    const int quad = piece.quad_j * tissue.n_xi + piece.quad_i;
    const double inside = 0.25 * std::accumulate(piece.share.begin(), piece.share.end(), 0.0);
    const double of_quad =
        (piece.box.xi_max - piece.box.xi_min) * tissue.n_xi * (piece.box.eta_max - piece.box.eta_min) * tissue.n_eta;
    sum[quad] += inside * of_quad * pressure[piece.cell];
    covered[quad] = true;
  }
  std::vector<WallPressure> walls;
  for (int quad = 0; quad < n_quads; ++quad) {
    if (covered[quad]) walls.push_back({quad % tissue.n_xi, quad / tissue.n_xi, sum[quad]});
  }
  return walls;
}

}  // namespace lipofill::exporting
