#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/coupling/film_solve.h"
#include "core/coupling/wall_compliance.h"
#include "core/mechanics/film_cells.h"
#include "core/mechanics/film_geometry.h"

namespace lipofill::step {

/// The response of the walls of all films to pressure, in the order of all cells: gap = rest + C p.
/// Cells on tissue take their C from its factor, those on Winkler walls a/k, those between rigid
/// walls 0.
class WallResponse {
 public:
  /// @param factor  null without tissue; what is passed here outlives the response
  WallResponse(const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
               const mechanics::FilmGeometry& geometry, plan::CouplingMode coupling, coupling::CoupledFactor* factor);

  /// Brings the compliance to what the factor holds.
  void update();
  const coupling::WallCompliance& compliance() const { return walls_; }
  /// True when C of the tissue is known by its products with vectors alone.
  bool is_implicit() const { return factor_ != nullptr && !factor_->has_compliance(); }

  /// Volume of the films at rest [m3] (n cells).
  const Eigen::VectorXd& rest_volume() const { return rest_volume_; }
  /// Rest + C p of the cells that have walls of their own, rest of the others [m3] (n cells).
  void compute_gap_of_own_walls(const Eigen::VectorXd& pressure, Eigen::VectorXd& gap) const;
  /// Sum over cells of |gap - fat - void| over the films' volume; under LUMPED, which conserves the
  /// sum alone, of the sum.
  double relative_gap_error(const Eigen::VectorXd& gap, const coupling::FilmSolution& solution) const;

 private:
  void set_full_compliance(const Eigen::MatrixXd& of_tissue);

  const std::vector<plan::FilmLayout>& films_;
  const mechanics::FilmCells& cells_;
  const mechanics::FilmGeometry& geometry_;
  plan::CouplingMode coupling_;
  coupling::CoupledFactor* factor_;
  Eigen::VectorXd rest_volume_;
  coupling::WallCompliance walls_;
  Eigen::MatrixXd full_compliance_;  ///< of all cells, when films with other walls stand beside those on tissue
};

}  // namespace lipofill::step
