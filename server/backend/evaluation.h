#pragma once

#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/geometry/surface_mesh.h"
#include "core/model/face_model.h"
#include "lipofill/v1/frame_service.pb.h"
#include "lipofill/v1/simulation_service.pb.h"

namespace lipofill::server {

/// The part of a simulated skin that a target is compared with.
struct SkinPatch {
  std::string mesh;                ///< "scan", or "skin" on a square
  std::vector<uint32_t> vertices;  ///< they count in that mesh, ascending
  geometry::SurfaceMesh before;    ///< is the surface at rest
  geometry::SurfaceMesh after;     ///< displaced; the same triangles
};

/// Takes the skin that is compared: on a scan the triangles whose three vertices ride on the model,
/// on a square the whole skin, each quadrilateral cut in two. DATA_LOSS when the arrays do not fit
/// the model.
absl::StatusOr<SkinPatch> make_skin_patch(const model::FaceModel& model, const v1::MeshSlice& meshes,
                                          const v1::FrameSlice& frame);

/// Compares the patch with a target. RESOURCE_EXHAUSTED for a patch of more vertices than a
/// response holds, CANCELLED once it is unwanted.
absl::StatusOr<v1::Evaluation> evaluate(const SkinPatch& patch, const geometry::SurfaceMesh& target,
                                        const Unwanted& unwanted);

}  // namespace lipofill::server
