#include "core/equilibrium/static_balance.h"

#include <limits>

namespace lipofill::equilibrium {

StaticBalance::StaticBalance(mechanics::TissueSystem& system, const std::vector<plan::FilmLayout>& films,
                             const mechanics::FilmCells& cells, const Pools& pools, mechanics::FilmGeometry& geometry,
                             const StaticLoad& load)
    : system_(system), films_(films), cells_(cells), pools_(pools), geometry_(geometry), load_(load) {
  cells.gather_tissue_part(geometry.rest_volume(), rest_);
  const solid::Tissue& tissue = system.tissue();
  const std::vector<int>& dofs = tissue.dof_of_component();
  weight_.setZero(tissue.n_dofs());
  for (size_t k = 0; k < dofs.size(); ++k) {
    const auto component = static_cast<Eigen::Index>(k % 3);
    if (dofs[k] >= 0) weight_[dofs[k]] = tissue.mass()[static_cast<Eigen::Index>(k / 3)] * load.gravity[component];
  }
}

void StaticBalance::bring_to(const Shape& shape, const Eigen::VectorXd& springs) {
  bring_gaps_to(shape);
  bring_forces_to_gaps(shape, springs);
}

void StaticBalance::bring_gaps_to(const Shape& shape) {
  positions_ = system_.rest_positions();
  system_.add_displacement(shape.displacement, positions_);
  system_.evaluate_gaps(positions_);
  gap_ = rest_ + system_.gaps().volume();
}

void StaticBalance::bring_forces_to_gaps(const Shape& shape, const Eigen::VectorXd& springs) {
  system_.bring_forces_to(positions_, springs, std::numeric_limits<double>::infinity());
  cell_pressure_ = shape.spread(pools_, shape.pressure);
  if (!load_.gravity.isZero(0.0)) {
    find_hydrostatic_pressure();
    cell_pressure_ += hydrostatic_;
  }
  of_films_.noalias() = derivative().transpose() * cell_pressure_;
  force_ = weight_ - system_.tissue().internal_force() + of_films_;
  scale_ = of_films_.norm() + system_.tissue().internal_force().norm() + system_.least_force();
}

void StaticBalance::find_hydrostatic_pressure() {
  Eigen::VectorXd all(cells_.n());
  for (size_t f = 0; f < films_.size(); ++f) {
    const film::FilmMetric& metric = geometry_.update(f, positions_);
    all.segment(cells_.offset[f], cells_.n_of(f)) = load_.fat_density * (metric.centre.transpose() * load_.gravity);
  }
  cells_.gather_tissue_part(all, hydrostatic_);
}

bool StaticBalance::is_folded() const {
  return system_.tissue().is_folded() || !(system_.tissue().min_volume_ratio() > 0.0);
}

}  // namespace lipofill::equilibrium
