#pragma once

#include <memory>

#include "core/model/face_model.h"

namespace lipofill::model {

/// The model with one layer thicker by a share everywhere, for derivatives by its thickness: along
/// the line of nodes below each node of the skin, what lies in the layer is stretched, and what
/// lies below it is moved. It has the same hexahedra and no scan. Checked by
/// tests/unit/model/thicker_model_test.cc.
/// @param share  small enough that no hexahedron turns inside out
std::shared_ptr<const FaceModel> make_thicker(const FaceModel& model, int layer, double share);

/// The model with every layer's thickness multiplied by a factor (n_layers), for members of
/// ensembles. Its hexahedra may be turned inside out where a factor is large.
std::shared_ptr<const FaceModel> with_thickness(const FaceModel& model, const Eigen::VectorXd& factors);

}  // namespace lipofill::model
