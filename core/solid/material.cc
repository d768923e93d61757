#include "core/solid/material.h"

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"

namespace lipofill::solid {
namespace {

void check_positive(const std::string& field, double value, const char* unit, FieldViolations& violations) {
  if (std::isfinite(value) && value > 0.0) return;
  violations.add(field, absl::StrCat("is ", value, " ", unit, ", must be finite and greater than 0"));
}

}  // namespace

void check_material(std::string_view field, const ElasticMaterial& material, FieldViolations& violations) {
  const std::string prefix(field);
  check_positive(prefix + ".youngs_modulus", material.youngs_modulus, "Pa", violations);
  violations.check_half_open(prefix + ".poisson_ratio", material.poisson_ratio, 0.0, 0.5, "");
  check_positive(prefix + ".density", material.density, "kg/m3", violations);
  if (std::isfinite(material.prestress) && material.prestress >= 0.0) return;
  violations.add(prefix + ".prestress", absl::StrCat("is ", material.prestress, " Pa, must be finite and at least 0"));
}

Eigen::Matrix<double, 6, 6> compute_elasticity_matrix(const ElasticMaterial& material) {
  const double E = material.youngs_modulus;
  const double nu = material.poisson_ratio;
  const double lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  const double mu = E / (2.0 * (1.0 + nu));
  Eigen::Matrix<double, 6, 6> D = Eigen::Matrix<double, 6, 6>::Zero();
  D.topLeftCorner<3, 3>().setConstant(lambda);
  D.topLeftCorner<3, 3>().diagonal().array() += 2.0 * mu;
  D.bottomRightCorner<3, 3>().diagonal().setConstant(mu);
  return D;
}

}  // namespace lipofill::solid
