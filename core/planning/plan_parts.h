#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::planning {

/// Zones that come nearer to one another touch [m] (assumed): as far as that the fat of one lifts
/// the skin of the other, and a model has that much skin around its zones (decision 041).
inline constexpr double kTouching = 12e-3;

/// The place says where a part of a face is.
struct PartPlace {
  std::vector<int> skin;  ///< vertices of the scan that ride on its model, ascending
  Eigen::Matrix3Xd fat;   ///< the middle of each cell of its zones, on the skin at rest [m]
};

/// Places a part. INVALID_ARGUMENT with field violations as place_plan().
/// Checked by tests/unit/planning/plan_parts_test.cc.
absl::StatusOr<PartPlace> place_part(const model::FaceModel& model, const plan::SimulationSpec& plan);

/// Tells how near zones of the two come to one another [m]; infinity for a part without any.
double find_distance(const PartPlace& one, const PartPlace& other);

/// Vertices of the scan that ride on the models of both.
int count_shared_vertices(const PartPlace& one, const PartPlace& other);

/// A number a part, equal for those that touch, directly or through others: that of the first of
/// them.
std::vector<size_t> group_touching(const std::vector<PartPlace>& parts);

/// The largest distance of a part from the part that is nearest to it [m].
double find_widest_gap(const std::vector<PartPlace>& parts);

}  // namespace lipofill::planning
