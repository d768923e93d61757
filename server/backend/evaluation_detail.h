#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/unwanted.h"
#include "core/geometry/surface_mesh.h"
#include "core/model/face_model.h"
#include "lipofill/v1/frame_service.pb.h"
#include "lipofill/v1/simulation.pb.h"
#include "lipofill/v1/simulation_service.pb.h"
#include "server/backend/evaluation.h"

namespace lipofill::server {

/// The zones of a plan over the vertices of a patch.
struct PatchZones {
  std::vector<std::string> names;  ///< in the order of the plan
  std::vector<int> of_vertex;      ///< a place in `names` a vertex of the patch; -1: none
};

/// Reads them from the field "skin.zone" of the frame; no names where it has none.
PatchZones find_patch_zones(const model::FaceModel& model, const v1::SimulationSpec& spec, const SkinPatch& patch,
                            const v1::FrameSlice& frame);

/// Adds to an evaluation what is without rim, by zone, and of the face's symmetry.
absl::Status add_details(const model::FaceModel& model, const SkinPatch& patch, const PatchZones& zones,
                         const geometry::SurfaceMesh& target, double rim_width, const Unwanted& unwanted,
                         v1::Evaluation& evaluation);

}  // namespace lipofill::server
