#pragma once

#include <string>
#include <vector>

#include "core/base/field_violations.h"
#include "core/film/cell_pieces.h"
#include "core/film/film_grid.h"
#include "core/geometry/level.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"
#include "core/plan/zone_feather.h"

namespace lipofill::plan {

/// The placed zones say what the zones of a film cover of its slots.
struct PlacedZones {
  std::vector<int> zone_of_slot;       ///< whose cell a slot is, -1: of no zone
  std::vector<film::SlotCover> cover;  ///< of each slot by its own zone
  std::vector<film::SlotFragment> fragments;
  std::vector<DrawnZone> drawn;  ///< each zone's own part; outlines are twice as fine as the grid of the tissue
  /// Levels of each zone that are all positive where its fat may be, without the corners that their
  /// minimum has: as drawn, or as far as it feathers (zone_feather.h).
  std::vector<std::vector<geometry::Level>> cutting;
  std::vector<std::vector<geometry::OutlineLoop>> outlines;  ///< around where the fat of each zone may be
  std::vector<geometry::ScalarField> distances;              ///< find_signed_distance where fat feathers, or none
  double uncounted = 0.0;                                    ///< slots' worth of zones that no cell could take
  double uncounted_share() const;                            ///< the same, of all that the zones cover
};

/// Finds the cells of each zone. Where zones overlap the earlier one has the place. With
/// ZoneOutline::kCurve the outlines cut the slots they cross; a slot of which a zone covers less
/// than a quarter, or less than another zone, counts as part of the zone's cell beside it. Field
/// violations are named "zones[index]" and below; remarks say what of a zone lies outside the film
/// or in no cell. Checked by tests/unit/plan/zone_placement_test.cc.
PlacedZones place_zones(const model::FaceModel& model, const FilmSpec& spec, FieldViolations& violations,
                        std::vector<std::string>& remarks);

/// Gives each piece of a cell its share inside the outline of the cell's zone and leaves out those
/// without any.
std::vector<film::CellPiece> cut_at_outlines(std::vector<film::CellPiece> pieces, const film::FilmGrid& grid,
                                             const PlacedZones& zones);

/// Middle of a slot of a film's grid, cell or not.
geometry::ChartPoint slot_centre(const FilmSpec& spec, int slot);

}  // namespace lipofill::plan
