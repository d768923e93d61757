#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/forecast/sampling.h"

namespace lipofill::forecast {

/// The influence tells how much of a figure's variance an input causes, by Sobol: by itself, and
/// with all that it does together with others. With standard errors.
struct Influence {
  double first_order = 0.0;
  double total = 0.0;
  double first_order_error = 0.0;
  double total_error = 0.0;
};

struct Influences {
  std::vector<Influence> of_input;
  /// Share of the variance that the polynomials leave, each member told by the others.
  double unexplained = 0.0;
};

/// Sobol indices of a figure from its polynomial chaos: with orthonormal polynomials psi,
///
///     y = sum_a c_a psi_a(x),   S_i = sum of c_a^2 where a has i alone / sum of c_a^2,   a != 0
///     T_i = the same where a has i
///
/// over the terms that say most (sampling.h), fitted by least squares. Errors: the coefficients are
/// fitted again to members drawn with replacement. A figure that does not vary has no influences
/// and leaves nothing.
/// Checked by tests/verification/forecast/ishigami_test.cc and
/// tests/unit/forecast/influence_test.cc.
///
/// @param standard     variables of the members, normal or uniform on [-1, 1] (n, inputs)
/// @param is_gaussian  an input
/// @param figure       of each member (n)
Influences find_influences(const Eigen::MatrixXd& standard, const std::vector<bool>& is_gaussian,
                           const Eigen::VectorXd& figure);

/// The orthonormal polynomial of a degree: Hermite's under the normal distribution, Legendre's
/// under the uniform one on [-1, 1].
double orthonormal_polynomial(bool gaussian, int degree, double x);

}  // namespace lipofill::forecast
