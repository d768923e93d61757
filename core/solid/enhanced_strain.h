#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <array>

#include "core/solid/hex_shape.h"

namespace lipofill::solid {

/// The tensor components of the six Voigt rows.
inline constexpr std::array<std::array<int, 2>, 6> kVoigt = {{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};

using StrainOperator = Eigen::Matrix<double, 6, 24>;

/// Linear strain in convective coordinates, Voigt order (11, 22, 33, 12, 23, 31), shear doubled:
///
///     epsilon_ij = 1/2 (G_i . du/dxi_j + G_j . du/dxi_i)
StrainOperator compute_covariant_strain_operator(const HexNodes& nodes, const LocalPoint& point);

/// T with epsilon_cartesian = T epsilon_covariant, both in Voigt order with doubled shear, for the
/// Jacobian J: epsilon_kl = dxi_i/dX_k dxi_j/dX_l epsilon_ij.
Eigen::Matrix<double, 6, 6> compute_strain_transform(const Eigen::Matrix3d& jacobian);

/// Stiffness of a hexahedron with enhanced strains (Simo & Rifai 1990):
///
///     epsilon = T(J) Bcov(xi) u + det J0 / det J  T(J0) M(xi) alpha
///     K = Kuu - Kua Kaa^-1 Kau                             alpha condensed, J0 the Jacobian at the centre
///
/// over 2 x 2 x 2 Gauss points. The columns of M integrate to zero over the cube, so a constant
/// stress does no work in them.
/// @param strain_operator  (point) -> Bcov (6, 24)
/// @param enhanced_modes   (point) -> M (6, kModes), covariant
template <int kModes, class StrainFunction, class ModesFunction>
HexStiffness compute_enhanced_stiffness(const HexNodes& nodes, const Eigen::Matrix<double, 6, 6>& elasticity,
                                        const StrainFunction& strain_operator, const ModesFunction& enhanced_modes) {
  const Eigen::Matrix3d J0 = compute_jacobian(nodes, LocalPoint::Zero());
  const Eigen::Matrix<double, 6, 6> T0 = compute_strain_transform(J0);
  HexStiffness Kuu = HexStiffness::Zero();
  Eigen::Matrix<double, kModes, 24> Kau = Eigen::Matrix<double, kModes, 24>::Zero();
  Eigen::Matrix<double, kModes, kModes> Kaa = Eigen::Matrix<double, kModes, kModes>::Zero();
  for (const LocalPoint& point : hex_gauss_points()) {
    const Eigen::Matrix3d J = compute_jacobian(nodes, point);
    const double volume = J.determinant();
    const StrainOperator B = compute_strain_transform(J) * strain_operator(point);
    const Eigen::Matrix<double, 6, kModes> G = (J0.determinant() / volume) * (T0 * enhanced_modes(point));
    Kuu += volume * (B.transpose() * elasticity * B);
    Kau += volume * (G.transpose() * elasticity * B);
    Kaa += volume * (G.transpose() * elasticity * G);
  }
  const HexStiffness K = Kuu - Kau.transpose() * Kaa.ldlt().solve(Kau);
  return 0.5 * (K + K.transpose());
}

}  // namespace lipofill::solid
