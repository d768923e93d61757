#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/forecast/forecast.h"

namespace lipofill::forecast {

/// This finds what the plan's own shape says of volumes: solves of the settled shape with all of
/// the plan's volumes multiplied by one number. Errors as TrialShape::create and find. Checked by
/// tests/unit/forecast/forecast_test.cc.

/// The share of the plan's fat that a follow-up found. From the volume that the skin has gained it
/// is the share with which the plan's shape gains as much (secants), with the error of the
/// measurement over the slope.
absl::StatusOr<KeptShare> find_kept_share(const std::shared_ptr<const model::FaceModel>& model,
                                          const plan::SimulationSpec& plan, const FollowUp& found,
                                          const Retention& retention);

/// The largest multiple of the plan's volumes under which the mean pressure of each zone stays
/// below its bound: of those up to 4, infinity above that. A multiple that the tissue does not hold
/// counts as above every bound.
absl::StatusOr<Eigen::VectorXd> find_largest_multiples(const std::shared_ptr<const model::FaceModel>& model,
                                                       const plan::SimulationSpec& plan,
                                                       const std::vector<std::string>& zones,
                                                       const Eigen::VectorXd& bounds);

}  // namespace lipofill::forecast
