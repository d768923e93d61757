#pragma once

#include "client/cpp/landmarks_file.h"
#include "lipofill/v1/model.pb.h"

namespace lipofill::client {

/// Which way the face of a model looks, for pictures: its axes where it has them, else those that
/// its landmarks give: up along the midline, left across pairs of landmarks. Without either, and on
/// a square, x is to the left, y up and z forward. Unit vectors across one another. Checked by
/// tests/integration/cli/report_test.cc.
Axes axes_to_draw(const v1::ModelSpec& model);

}  // namespace lipofill::client
