#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/shared_cache.h"
#include "core/coupling/factor_analysis.h"
#include "core/coupling/gap_geometry.h"
#include "core/film/film_grid.h"
#include "core/geometry/layered_grid.h"
#include "core/solid/tissue_structure.h"

namespace lipofill::model {

/// The response tells how tissue at rest answers, by a factor there: core/equilibrium/rest_start.h.
struct RestResponse {
  Eigen::MatrixXd of_pools;  ///< to a pressure in each pool [m/Pa] (n_dofs, n_pools)
  Eigen::VectorXd of_load;   ///< to what is out of balance [m] (n_dofs)
  bool is_double = false;    ///< float32 was not enough
};

/// Parts that all simulations of a model share as long as one of them lives: element matrices and
/// patterns, the places of the gaps on the tissue, the analysis of the factorisation. None of it is
/// written once it is made, and it is the same whoever makes it first: results do not depend on the
/// sharing. Young's moduli are no part of them but of rest responses, so that tissues of other
/// stiffness share them too; and models that differ in thickness alone share what patterns decide.
/// Thread-safe. Checked by tests/unit/model/shared_parts_test.cc.
struct SharedParts {
  SharedCache<solid::TissueStructure> tissues;
  SharedCache<coupling::GapGeometry> gaps;
  SharedCache<coupling::FactorAnalysis> analyses;
  SharedCache<RestResponse> rest_responses;
};

/// Keys over all that a part is made from. What depends on the pattern alone (how its
/// hexahedra hang together, what holds them) is shared by tissues of every thickness.
std::string key_of_pattern(const solid::HexMesh& mesh, const solid::NodeSupports& supports,
                           const std::vector<solid::WallSpring>& springs);
std::string key_of_tissue(const std::string& pattern_key, const solid::HexMesh& mesh,
                          const std::vector<solid::ElasticMaterial>& materials, const solid::NodeSupports& supports,
                          const std::vector<solid::WallSpring>& springs);
std::string key_of_gap(const std::string& pattern_key, const geometry::LayeredGrid& grid,
                       const coupling::WallNodes& walls, const film::FilmGrid& film,
                       const std::vector<film::CellPiece>& pieces);
/// @param has_pressures  the pressures are in the factorisation
std::string key_of_analysis(const std::string& pattern_key, const std::vector<std::string>& gap_keys,
                            bool has_pressures);

}  // namespace lipofill::model
