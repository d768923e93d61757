#pragma once

#include <Eigen/Core>
#include <vector>

namespace lipofill::forecast {

/// This is what OpenTURNS does for forecasts; no other source includes it, for it takes long to
/// compile. Thread-safe: calls take turns, since OpenTURNS keeps state for all. Decision record:
/// core/doc/decisions/037-ensembles.md. Checked by tests/unit/forecast/sampling_test.cc.

/// The first points of Sobol's sequence in (0, 1) (n, dimensions): they fill the cube more evenly
/// than random points, and the first of more points are the points of fewer.
Eigen::MatrixXd draw_points(int n, int dimensions);

/// A product of polynomials, one of each variable, by their degrees.
using Term = std::vector<int>;

/// The products that say most of a figure, the constant among them: least angle regression over
/// all of a hyperbolic degree, and of its steps the one with the least leave-one-out error (Blatman
/// & Sudret 2011).
/// @param standard     variables of the members (n, inputs)
/// @param is_gaussian  an input: it is normal, else uniform on [-1, 1]
/// @param stratum      of the hyperbolic set: products enter by strata of equal size of their degrees
std::vector<Term> select_terms(const Eigen::MatrixXd& standard, const std::vector<bool>& is_gaussian,
                               const Eigen::VectorXd& figure, int stratum);
/// Counts how many products there are to select from.
int count_terms(int inputs, int stratum);

}  // namespace lipofill::forecast
