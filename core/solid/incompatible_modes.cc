#include "core/solid/incompatible_modes.h"

#include "core/solid/enhanced_strain.h"

namespace lipofill::solid {
namespace {

Eigen::Matrix<double, 6, 9> compute_modes(const LocalPoint& point) {
  const double xi = point[0];
  const double eta = point[1];
  const double zeta = point[2];
  Eigen::Matrix<double, 6, 9> M = Eigen::Matrix<double, 6, 9>::Zero();
  M(0, 0) = xi;
  M(1, 1) = eta;
  M(2, 2) = zeta;
  M(3, 3) = xi;
  M(3, 4) = eta;
  M(4, 5) = eta;
  M(4, 6) = zeta;
  M(5, 7) = zeta;
  M(5, 8) = xi;
  return M;
}

}  // namespace

HexStiffness compute_incompatible_modes_stiffness(const HexNodes& nodes,
                                                  const Eigen::Matrix<double, 6, 6>& elasticity) {
  const auto strain = [&](const LocalPoint& point) { return compute_covariant_strain_operator(nodes, point); };
  return compute_enhanced_stiffness<9>(nodes, elasticity, strain, compute_modes);
}

}  // namespace lipofill::solid
