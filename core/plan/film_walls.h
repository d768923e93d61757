#pragma once

#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/film/film_grid.h"
#include "core/model/face_model.h"
#include "core/plan/simulation_spec.h"

namespace lipofill::plan {

/// A film's walls as pairs of slots, the lower first, with what seeps through a metre of them.
struct PlacedWalls {
  film::WalledSlots inside_zones;
  std::vector<std::pair<std::pair<int, int>, double>> leaky;  ///< leakage [m2/(Pa s)], > 0
};

/// Finds the pairs of neighbouring slots that the film's walls part: those whose centres lie on the
/// two sides of a path, and those of two zones that touch. Field violations are named below
/// "walls[index]". Checked by tests/unit/simulation/anatomy_input_test.cc and
/// tests/verification/film/walls_test.cc.
absl::StatusOr<PlacedWalls> place_walls(const model::FaceModel& model, const FilmSpec& spec,
                                        const std::vector<int>& zone_of_slot);

/// Walls that leak, with their conductance = leakage times length on the undeformed skin.
std::vector<film::LeakyWall> find_leaky_walls(const geometry::LayeredGrid& tissue, const film::FilmGrid& film,
                                              const PlacedWalls& walls);

}  // namespace lipofill::plan
