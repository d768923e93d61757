#pragma once

#include <Eigen/Core>
#include <string_view>

#include "core/base/field_violations.h"

namespace lipofill::solid {

/// The law says how stress follows from strain.
enum class TissueLaw {
  kCorotational,  ///< the paper's: linear between stress and strain in each element's rotated frame (tissue.h)
  kNeoHookean,    ///< nearly incompressible at any strain (neo_hookean_batch.h)
};

/// Isotropic elasticity, under tension at rest (prestress.h). Constants are those at small strain.
struct ElasticMaterial {
  double youngs_modulus = 0.0;  ///< E   [Pa]     > 0
  double poisson_ratio = 0.0;   ///< nu  [1]      in [0, 0.5)
  double density = 0.0;         ///< rho [kg/m3]  > 0
  double prestress = 0.0;       ///< sigma_0 [Pa] in the plane of the layer, >= 0
  TissueLaw law = TissueLaw::kCorotational;
};

/// Adds a violation below `field` for each constant that is out of its bounds, not finite or not a
/// number.
void check_material(std::string_view field, const ElasticMaterial& material, FieldViolations& violations);

/// Stress of a strain in Voigt order (xx, yy, zz, xy, yz, zx), shear strains as engineering
/// strains: sigma = D epsilon. [Pa]
///
///     D = lambda 1 (x) 1 + 2 mu I,   lambda = E nu / ((1 + nu)(1 - 2 nu)),   mu = E / (2 (1 + nu))
///
/// Checked by tests/unit/solid/material_test.cc.
Eigen::Matrix<double, 6, 6> compute_elasticity_matrix(const ElasticMaterial& material);

}  // namespace lipofill::solid
