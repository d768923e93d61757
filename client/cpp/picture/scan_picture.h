#pragma once

#include "absl/status/status.h"
#include "client/cpp/picture/result_picture.h"

namespace lipofill::client {

/// Draws a scan that nothing was simulated on from three sides: along the z, x and y axes of its
/// file, the borders of the surface and edges of more than two triangles in red, the request's
/// remarks below. Of the request, mesh (a .vtp), png, caption and remarks count. 2100 x 1000
/// pixels. As draw_result_picture it needs an X server. INVALID_ARGUMENT for a mesh that cannot be
/// read. Checked by tests/integration/cli/scan_check_test.cc.
absl::Status draw_scan_picture(const PictureRequest& request);

}  // namespace lipofill::client
