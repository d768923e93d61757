#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/film/film_grid.h"
#include "core/film/rheology.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

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

  int cell_at(const geometry::ChartPoint& place) const;
  geometry::ChartPoint cell_centre(int cell) const;
};

/// Decides which cells belong to which zone and where in the tissue the film lies. Field violations
/// are named below "films[index]", values in the units of lipofill.v1.Film.
absl::StatusOr<FilmLayout> place_film(const model::FaceModel& model, const FilmSpec& spec);

/// Middle of a slot of a film's grid, cell or not.
geometry::ChartPoint slot_centre(const FilmSpec& spec, int slot);

/// Positions on the undeformed skin over the vertices of a film's grid [m] (3, n_vertices).
Eigen::Matrix3Xd vertices_on_skin(const geometry::LayeredGrid& grid, const film::FilmGrid& film);

/// Flags of the level's nodes that are doubled: all quadrilaterals around the node lie in cells of
/// one zone, on one side of its walls. The tissue stays bonded along the edges of zones and along
/// walls.
std::vector<bool> find_open_nodes(const geometry::LayeredGrid& tissue, const FilmLayout& layout);

}  // namespace lipofill::plan
