#pragma once

#include <Eigen/Core>

#include "core/geometry/layered_grid.h"
#include "core/geometry/scalar_field.h"

namespace lipofill::geometry {

/// Makes every value that is not finite the harmonic continuation of those around: the mean of its
/// neighbours in the grid. Values stay as they are where none is finite. Checked by
/// tests/unit/geometry/bone_depth_test.cc.
void fill_harmonically(const LayeredGrid& grid, Eigen::VectorXd& values);

/// Makes values that are not finite go over into `general`: their difference c from it solves
///
///     c - L^2 Laplace c = 0
///
/// in the gaps, with the c of the finite values around, so that it fades as exp(-x / L) with the
/// distance x from what is known. Finite values stay as they are.
/// @param general  at each node, finite, in the unit of the values
/// @param length   L [m], > 0
/// Second order in the mean spacing. Checked by tests/unit/geometry/gap_filling_test.cc.
void fill_towards(const LayeredGrid& grid, const Eigen::VectorXd& general, double length, Eigen::VectorXd& values);

/// Tells whether a field has places without a value: samples that are not a number.
bool has_gaps(const ScalarField& field);

/// The field with the mean of the samples that are numbers in its gaps, as it is checked; without
/// any such sample it stays as it is.
ScalarField without_gaps(const ScalarField& field);

/// A field with gaps at the nodes of a skin; not a number where one of the samples between which a
/// node lies is none.
Eigen::VectorXd sample_with_gaps(const ScalarField& field, const LayeredGrid& grid);

}  // namespace lipofill::geometry
