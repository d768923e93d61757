#include "core/solid/solid_shell.h"

#include "core/solid/enhanced_strain.h"

namespace lipofill::solid {
namespace {

constexpr int kThickness = 2;  // Voigt row of strain 33
constexpr int kShear23 = 4;
constexpr int kShear31 = 5;

using StrainRow = Eigen::Matrix<double, 1, 24>;

/// Strains at the tying points, interpolated anywhere in the element.
class AssumedStrains {
 public:
  explicit AssumedStrains(const HexNodes& nodes) {
    const auto row_at = [&nodes](int row, double xi, double eta) -> StrainRow {
      return compute_covariant_strain_operator(nodes, LocalPoint(xi, eta, 0.0)).row(row);
    };
    const HexNodes corners = hex_corners();
    for (int c = 0; c < 4; ++c) thickness_[c] = row_at(kThickness, corners(0, c), corners(1, c));
    for (int side = 0; side < 2; ++side) {
      const double s = 2.0 * side - 1.0;
      shear31_[side] = row_at(kShear31, 0.0, s);
      shear23_[side] = row_at(kShear23, s, 0.0);
    }
  }

  /// Overwrites the transverse rows of B.
  void apply(const LocalPoint& point, StrainOperator& B) const {
    const double xi = point[0];
    const double eta = point[1];
    B.row(kShear31) = 0.5 * (1.0 - eta) * shear31_[0] + 0.5 * (1.0 + eta) * shear31_[1];
    B.row(kShear23) = 0.5 * (1.0 - xi) * shear23_[0] + 0.5 * (1.0 + xi) * shear23_[1];
    const HexNodes corners = hex_corners();
    B.row(kThickness).setZero();
    for (int c = 0; c < 4; ++c) {
      B.row(kThickness) += 0.25 * (1.0 + corners(0, c) * xi) * (1.0 + corners(1, c) * eta) * thickness_[c];
    }
  }

 private:
  std::array<StrainRow, 4> thickness_;
  std::array<StrainRow, 2> shear31_;
  std::array<StrainRow, 2> shear23_;
};

Eigen::Matrix<double, 6, 7> compute_modes(const LocalPoint& point) {
  const double xi = point[0];
  const double eta = point[1];
  const double zeta = point[2];
  Eigen::Matrix<double, 6, 7> M = Eigen::Matrix<double, 6, 7>::Zero();
  M(0, 0) = xi;
  M(1, 1) = eta;
  M(2, 2) = zeta;
  M(2, 3) = xi * zeta;
  M(2, 4) = eta * zeta;
  M(3, 5) = xi;
  M(3, 6) = eta;
  return M;
}

}  // namespace

HexStiffness compute_solid_shell_stiffness(const HexNodes& nodes, const Eigen::Matrix<double, 6, 6>& elasticity) {
  const AssumedStrains assumed(nodes);
  const auto strain = [&](const LocalPoint& point) {
    StrainOperator B = compute_covariant_strain_operator(nodes, point);
    assumed.apply(point, B);
    return B;
  };
  return compute_enhanced_stiffness<7>(nodes, elasticity, strain, compute_modes);
}

}  // namespace lipofill::solid
