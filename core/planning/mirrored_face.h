#pragma once

#include "core/geometry/surface_mesh.h"
#include "core/planning/reflection.h"

namespace lipofill::planning {

/// Which half of the face is the healthy one; the subject's own.
enum class FaceSide { kLeft, kRight };

/// A face of its healthy side and that side's mirror image. The healthy side is cut off at the
/// plane; both halves share the points there, so that no seam is open.
/// @param plane  its normal points to the subject's left
/// Checked by tests/unit/planning/mirrored_face_test.cc.
geometry::SurfaceMesh make_mirrored_face(const geometry::SurfaceMesh& skin, const Reflection& plane, FaceSide healthy);

}  // namespace lipofill::planning
