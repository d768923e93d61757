#pragma once

#include <Eigen/LU>
#include <limits>
#include <memory>

#include "core/equilibrium/equilibrium.h"
#include "core/equilibrium/held_response.h"
#include "tests/unit/mechanics/small_system.h"

namespace lipofill::equilibrium {

/// The small plan's tissue and film with the parts of an equilibrium.
struct SmallEquilibrium : mechanics::SmallSystem {
  using SmallSystem::SmallSystem;

  mechanics::FilmGeometry geometry{model->geometry.grid, films, cells, system.get()};
  Pools pools = find_pools(films, cells);
  StaticLoad load;
  std::unique_ptr<mechanics::TissueFactor> tissue_factor = *mechanics::TissueFactor::create(*model, *system, cost);

  StaticBalance make_balance() { return {*system, films, cells, pools, geometry, load}; }
  Shape at_rest() const { return Shape::at_rest(system->tissue().n_dofs(), pools); }
  /// A shape bent by up to `size` [m].
  Shape bent_shape(double size) const {
    Shape shape = at_rest();
    const Eigen::Matrix3Xd x = bent(size) - system->rest_positions();
    const std::vector<int>& dofs = system->tissue().dof_of_component();
    for (size_t k = 0; k < dofs.size(); ++k) {
      if (dofs[k] >= 0) shape.displacement[dofs[k]] = x.data()[k];
    }
    return shape;
  }
  /// Rest and `volume` in the first pool [m3].
  PoolTarget with(double volume) {
    PoolTarget target{pools.sum(geometry.rest_volume())};
    target.volume[0] += volume;
    return target;
  }
  Settled find(const PoolTarget& target, double tolerance) {
    auto equilibrium = Equilibrium::create(*model, films, cells, *system, geometry, load, cost);
    EXPECT_TRUE(equilibrium.ok()) << equilibrium.status();
    return (*equilibrium)->find(target, springs, tolerance);
  }
};

}  // namespace lipofill::equilibrium
