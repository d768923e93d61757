#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/coupling/gap_volume.h"
#include "core/model/face_model.h"
#include "core/plan/film_layout.h"
#include "core/plan/simulation_spec.h"
#include "core/solid/hex_mesh.h"
#include "core/solid/wall_springs.h"

namespace lipofill::mechanics {

/// The place of a ligament's springs among all.
struct LigamentLayout {
  std::string name;
  int first_spring = 0;
  int n_springs = 0;
  double breaking_force = 0.0;  ///< each spring breaks at it [N]; infinity: it holds
};

/// Springs across the films of a tissue: ligaments first, then the fibres of connective tissue and
/// of attachments.
struct WallFibres {
  std::vector<solid::WallSpring> springs;
  std::vector<LigamentLayout> ligaments;
};

/// The two walls of a film on tissue.
struct FilmOnTissue {
  const plan::FilmLayout* film = nullptr;
  const coupling::WallNodes* nodes = nullptr;
};

/// Joins the walls of films: a spring at each point of a ligament, bilinear between the nodes
/// around it, and one between the two copies of every open node, its stiffness that of connective
/// tissue times the node's share of area and that of the attachment at the edge of the zones
/// (plan/zone_bond.h).
/// Field violations are named below "ligaments[index]". Checked by
/// tests/verification/coupling/ligament_test.cc and tests/unit/simulation/anatomy_input_test.cc.
absl::StatusOr<WallFibres> place_wall_fibres(const model::FaceModel& model, const std::vector<FilmOnTissue>& films,
                                             const std::vector<plan::LigamentSpec>& ligaments,
                                             const solid::HexMesh& mesh);

}  // namespace lipofill::mechanics
