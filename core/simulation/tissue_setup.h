#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/coupling/gap_volume.h"
#include "core/coupling/split_mesh.h"
#include "core/simulation/face_model.h"
#include "core/simulation/film_layout.h"
#include "core/solid/tissue.h"

namespace lipofill::simulation {

/// The model's tissue, split where the films lie, and how its nodes are held.
struct TissueSetup {
  solid::Tissue tissue;
  std::vector<coupling::WallNodes> walls;  ///< a film on tissue, in the order of the films
  std::vector<int> skin_nodes;             ///< (nodes_per_level)
};

/// Only for a model with layers.
absl::StatusOr<TissueSetup> set_up_tissue(const FaceModel& model, const std::vector<FilmLayout>& films,
                                          const solid::RayleighDamping& damping);

}  // namespace lipofill::simulation
