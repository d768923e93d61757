#pragma once

#include "core/anatomy/regions.h"
#include "core/geometry/chart_box.h"
#include "core/geometry/face_geometry.h"

namespace lipofill::plan {

/// Share of an ellipse of skin that lies within a box of the chart: 192 points, spread evenly over the ellipse in the
/// tangent plane at its centre and brought to the skin, which goes on bilinearly beyond the rim. To 0.02. Checked by
/// tests/unit/plan/zone_share_test.cc.
double compute_zone_share(const geometry::FaceGeometry& face, const anatomy::PlacedRegion& region,
                          const geometry::ChartBox& box);

}  // namespace lipofill::plan
