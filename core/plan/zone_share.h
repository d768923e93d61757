#pragma once

#include <string>
#include <vector>

#include "core/anatomy/regions.h"
#include "core/base/field_violations.h"
#include "core/geometry/chart_box.h"
#include "core/geometry/face_geometry.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::plan {

/// Share of an ellipse of skin that lies within a box of the chart: 192 points, spread evenly over
/// the ellipse in the tangent plane at its centre and brought to the skin, which goes on bilinearly
/// beyond the rim. To 0.02. Checked by tests/unit/plan/zone_share_test.cc.
double compute_zone_share(const geometry::FaceGeometry& face, const anatomy::PlacedRegion& region,
                          const geometry::ChartBox& box);

/// A zone on a face that lies outside the film in part is not the zone that was asked for: of a
/// named region or a disc, a remark below 0.98 of its area and a violation of `field` below 0.6. On
/// a square a quarter of a disc is a usual way to use its symmetry.
void judge_zone_share(const model::FaceModel& model, const FilmSpec& spec, const ZoneSpec& zone,
                      const std::string& field, FieldViolations& violations, std::vector<std::string>& remarks);

}  // namespace lipofill::plan
