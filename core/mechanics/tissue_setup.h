#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/coupling/gap_volume.h"
#include "core/coupling/split_mesh.h"
#include "core/mechanics/wall_fibres.h"
#include "core/model/face_model.h"
#include "core/plan/film_layout.h"
#include "core/plan/simulation_spec.h"
#include "core/solid/tissue.h"

namespace lipofill::mechanics {

/// The model's hexahedra, split where the films lie, and how their nodes are held: what there is to
/// build a tissue from.
struct HeldMesh {
  coupling::SplitMesh split;
  solid::NodeSupports supports;
  std::vector<coupling::WallNodes> walls;  ///< a film on tissue, in the order of the films
  std::vector<int> skin_nodes;             ///< (nodes_per_level)
};

/// Opens the films in a model's mesh and holds it. The model must have layers.
HeldMesh hold_mesh(const model::FaceModel& model, const std::vector<plan::FilmLayout>& films);

/// The tissue of a held mesh.
struct TissueSetup {
  solid::Tissue tissue;
  std::vector<coupling::WallNodes> walls;  ///< a film on tissue, in the order of the films
  std::vector<int> skin_nodes;             ///< (nodes_per_level)
  std::vector<LigamentLayout> ligaments;
  std::string pattern_key;            ///< names what couples in the tissue (shared_parts.h)
  std::string key;                    ///< names its structure
  std::vector<double> youngs_moduli;  ///< of the model's layers [Pa]
};

/// Makes the tissue of a model, which must have layers. Field violations of the plan's ligaments.
absl::StatusOr<TissueSetup> set_up_tissue(const model::FaceModel& model, const std::vector<plan::FilmLayout>& films,
                                          const plan::SimulationSpec& spec);

}  // namespace lipofill::mechanics
