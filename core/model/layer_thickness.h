#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/field_violations.h"
#include "core/geometry/scalar_field.h"
#include "core/model/face_model.h"

namespace lipofill::model {

/// Adds what is wrong with how the layers ask for their thickness, before anything is built.
void check_thickness_requests(const FaceModelSpec& spec, FieldViolations& violations);

/// Thickness of all layers over the chart of a face.
struct LayerThickness {
  std::vector<geometry::ScalarField> fields;  ///< [m] a field a layer
  std::vector<ThicknessRange> ranges;
  std::optional<BoneFinding> bone;
  /// This says where the tissue does not end on bone, with a layer down to the bone only: 1 at a
  /// node of the skin where no bone was met or the layer ends above it, 0 where it ends on bone,
  /// smoothed.
  Eigen::VectorXd off_bone;
  /// Sentences that say, for each layer measured in places only, at what share of the nodes it was
  /// measured, and what stands for it elsewhere.
  std::vector<std::string> remarks;
};

/// How far from where a layer was measured its thickness goes over into the published one [m]:
/// fill_towards().
inline constexpr double kMeasuredReach = 0.006;

/// Thickness of a specification's layers under a charted skin: the layer's own field, the regional
/// figures of its kind, or what the other layers leave of the distance to the bone. The field of
/// layers that ask for neither stays as it is; where it has gaps (samples that are not a number,
/// places that were not measured) the figure of its kind stands, published for the region where
/// there are landmarks, into which the thickness goes over smoothly. INVALID_ARGUMENT with
/// violations of layers[k].regional_thickness and layers[k].down_to_bone that say where it does not
/// fit; FAILED_PRECONDITION where no bone is found. Checked by
/// tests/unit/model/layer_thickness_test.cc.
absl::StatusOr<LayerThickness> find_layer_thickness(const geometry::FaceGeometry& face, const FaceModelSpec& spec);

}  // namespace lipofill::model
