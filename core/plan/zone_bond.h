#pragma once

#include <vector>

#include "core/film/cell_pieces.h"
#include "core/film/film_grid.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"
#include "core/plan/zone_placement.h"

namespace lipofill::plan {

/// The bond says how the two walls of a film on tissue hold together, by the places of its level
/// (nodes_per_level).
struct ZoneBond {
  std::vector<bool> open;         ///< the place has a node on each wall; elsewhere the layers share one
  std::vector<double> stiffness;  ///< of the attachment between the two [N/m]
};

/// Bonds the layers outside the zones and along walls inside them.
///
/// An attachment of stiffness k(x) per area goes to the open places in shares int k N_a dA, N_a
/// bilinear. Outside the zones k = k1 d/w at a distance d along the skin from the nearest outline,
/// and the layers share their nodes from d = w on. Inside a zone a neighbour at a distance d < w/2
/// adds the septum between them, k1 (1 - 2 d/w). Fat that feathers into an attachment changes
/// nothing of it.
///
/// Rigid edges open the places whose four quadrilaterals all belong to one zone, the one with the
/// largest part of each, and tie them by what those
/// quadrilaterals have outside the outline with the stiffness of the tissue, E/L with L the side of
/// a quadrilateral: the place where the layers part moves with the outline, not by quadrilaterals.
/// Checked by tests/unit/plan/zone_bond_test.cc and tests/verification/coupling/zone_edge_test.cc.
ZoneBond bond_around_zones(const model::FaceModel& model, const FilmSpec& spec, int level, const film::FilmGrid& grid,
                           const std::vector<film::CellPiece>& pieces, const film::WalledSlots& walled_slots,
                           const PlacedZones& zones);

}  // namespace lipofill::plan
