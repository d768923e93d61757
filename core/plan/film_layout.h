#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/film/cell_pieces.h"
#include "core/film/film_grid.h"
#include "core/film/rheology.h"
#include "core/geometry/level.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"
#include "core/plan/zone_bond.h"

namespace lipofill::plan {

/// A film of the plan, placed on a model.
struct FilmLayout {
  std::string name;
  film::FilmGrid grid;
  std::vector<std::string> zone_names;  ///< FilmGrid::zone_of_cell has the index
  FilmWallKind wall = FilmWallKind::kTissue;
  double wall_stiffness = 0.0;  ///< [Pa/m]
  film::WallFriction wall_friction = film::WallFriction::kNoSlip;
  int level = -1;  ///< the tissue opens at this level, kTissue only
  geometry::ScalarField rest_thickness;
  geometry::ScalarField initial_thickness;
  film::WalledSlots walled_slots;  ///< they lie on both sides of walls inside zones
  ConnectiveTissueSpec connective_tissue;
  std::vector<std::vector<geometry::OutlineLoop>> outlines;  ///< around the fat of each zone, on the chart
  std::vector<std::vector<geometry::OutlineLoop>> drawn;     ///< each zone as drawn: fat may feather beyond
  std::vector<bool> is_feather;         ///< the cell lies beyond the outline of its zone: fat gets there by itself only
  std::vector<film::CellPiece> pieces;  ///< on the quadrilaterals of the tissue, kTissue only
  ZoneBond bond;                        ///< of the two walls, kTissue only
  std::vector<std::string> remarks;     ///< what to know of its zones and base, a sentence each

  /// The slot of the film's grid over a place, -1 outside its extent; and the cell whose slot it
  /// is, -1: none.
  int slot_at(const geometry::ChartPoint& place) const;
  int cell_at(const geometry::ChartPoint& place) const;
  geometry::ChartPoint cell_centre(int cell) const;
  /// True for the cells into which fat of a zone is injected.
  bool lies_in_zone(int cell, int zone) const { return grid.zone_of_cell[cell] == zone && !is_feather[cell]; }
};

/// A film whose numbers of cells are given: cells that nobody chose (0) are as wide as two
/// hexahedra, the narrowest there may be.
FilmSpec with_cells(FilmSpec spec, const geometry::LayeredGrid& tissue);

/// Decides which cells belong to which zone and where in the tissue the film lies. On a face a
/// named region or a disc with less than 0.98 of its area on the film is remarked upon, and refused
/// below 0.6. A film on the base is remarked upon where that gives, since it has bone beneath it in
/// the model (core/doc/decisions/026-base-by-region.md). Field violations are named below
/// "films[index]", values in the units of lipofill.v1.Film.
absl::StatusOr<FilmLayout> place_film(const model::FaceModel& model, const FilmSpec& spec);

/// Positions on the undeformed skin over the vertices of a film's grid [m] (3, n_vertices).
Eigen::Matrix3Xd vertices_on_skin(const geometry::LayeredGrid& grid, const film::FilmGrid& film);

}  // namespace lipofill::plan
