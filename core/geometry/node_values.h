#pragma once

#include <Eigen/Core>

#include "core/geometry/layered_grid.h"
#include "core/geometry/scalar_field.h"

namespace lipofill::geometry {

/// A field over the chart at the nodes of a skin (nodes_per_level).
Eigen::VectorXd sample_at_nodes(const ScalarField& field, const LayeredGrid& grid);

/// The field that has these values at the nodes of a skin, bilinear between them. Checked by
/// tests/unit/plan/coarse_plan_test.cc and tests/unit/model/layer_thickness_test.cc.
ScalarField field_of_nodes(const Eigen::VectorXd& values, const LayeredGrid& grid);

}  // namespace lipofill::geometry
