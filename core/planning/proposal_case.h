#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geometry/scalar_field.h"
#include "core/geometry/surface_distance.h"
#include "core/model/face_model.h"
#include "core/planning/proposal_points.h"

namespace lipofill::planning {

/// The closeness tells how near the skin that lacks something is to the target.
struct Closeness {
  geometry::DistanceStatistics skin_to_target;
  geometry::DistanceStatistics target_to_skin;
  geometry::VolumeBetween volume;
  int skin_vertices = 0;
};

/// A face and its target, with what is the same for every plan that is tried.
struct ProposalCase {
  std::shared_ptr<const model::FaceModel> model;
  SkinPoints points;
  std::unique_ptr<TargetDistance> target;
  geometry::ScalarField deficit;  ///< smooth_deficit() of the nodes [m]
  std::vector<bool> is_lacking;   ///< a point: the deficit there is at least the least one of the case
  Eigen::VectorXd distance;       ///< of the points at rest, NaN without a target opposite [m]
  double missing = 0.0;           ///< of the points that lack something: area times distance [m3]

  /// The points that lack something have this area [m2].
  double lacking_area() const;
  /// Root of the mean square over the points that lack something, and what 95 of 100 do not exceed.
  double rms(const Eigen::VectorXd& distances) const;
  double p95(const Eigen::VectorXd& distances) const;
  /// All figures of the skin moved by `displacement` of its nodes [m]. CANCELLED once unwanted.
  absl::StatusOr<Closeness> compare(const Eigen::Matrix3Xd& displacement, const Unwanted& unwanted) const;

 private:
  std::vector<double> of_lacking(const Eigen::VectorXd& distances) const;
};

/// FAILED_PRECONDITION, with figures, for a target that is not where the face is, or that lies
/// below the skin or outside of it by less than `min_deficit` everywhere. Checked by
/// tests/unit/planning/proposal_test.cc.
absl::StatusOr<ProposalCase> make_proposal_case(std::shared_ptr<const model::FaceModel> model,
                                                const geometry::SurfaceMesh& target, double min_deficit);

}  // namespace lipofill::planning
