#pragma once

#include <Eigen/Core>

namespace lipofill::solid {

/// Isotropic linear elasticity.
struct ElasticMaterial {
  double youngs_modulus = 0.0;  ///< E   [Pa]     > 0
  double poisson_ratio = 0.0;   ///< nu  [1]      in [0, 0.5)
  double density = 0.0;         ///< rho [kg/m3]  > 0
};

/// Stress of a strain in Voigt order (xx, yy, zz, xy, yz, zx), shear strains as engineering strains: sigma = D epsilon.  [Pa]
Eigen::Matrix<double, 6, 6> compute_elasticity_matrix(const ElasticMaterial& material);

}  // namespace lipofill::solid
