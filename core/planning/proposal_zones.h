#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/scalar_field.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"
#include "core/planning/proposal_bounds.h"

namespace lipofill::planning {

/// A zone whose volume is sought.
struct SoughtZone {
  std::string name;
  std::string below_layer;
  double missing = 0.0;  ///< what the skin over it lacks, shared with zones above and below it [m3]
  VolumeRange bounds;
};

/// The zones of a plan, in the order of its films.
/// INVALID_ARGUMENT with field violations as place_plan() and check_bounds().
/// @param deficit  of the skin (proposal_points.h) [m]
/// Checked by tests/unit/planning/proposal_test.cc.
absl::StatusOr<std::vector<SoughtZone>> find_sought_zones(const model::FaceModel& model,
                                                          const plan::SimulationSpec& plan,
                                                          const geometry::ScalarField& deficit,
                                                          const ProposalBounds& bounds);

/// The plan with one injection a zone, in the order of the zones, at the site and rate of the first
/// that it had there; of no volume yet. Its goal is the settled shape.
plan::SimulationSpec with_one_injection_each(plan::SimulationSpec plan);

/// The same with volumes, without injections of none; it ends after the last of them.
plan::SimulationSpec with_volumes(const plan::SimulationSpec& one_each, const Eigen::VectorXd& volumes);

/// The next lower whole thousandths of a millilitre [m3]: the same number in messages and files.
Eigen::VectorXd round_volumes(const Eigen::VectorXd& volumes);

/// Takes a zone out of a plan, and its film where it was the only one.
plan::SimulationSpec without_zone(plan::SimulationSpec plan, const std::string& name);

}  // namespace lipofill::planning
