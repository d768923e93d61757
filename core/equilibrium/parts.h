#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "core/equilibrium/contact.h"
#include "core/equilibrium/held_response.h"
#include "core/equilibrium/pools.h"
#include "core/equilibrium/shape.h"
#include "core/equilibrium/static_balance.h"
#include "core/mechanics/tissue_factor.h"
#include "core/mechanics/tissue_system.h"

namespace lipofill::equilibrium {

/// The parts are what the ways to an equilibrium share: the tissue with its balance, and the factor
/// with what it answers. Each way leaves the balance where it likes.
struct Parts {
  /// What is passed here outlives the parts.
  Parts(std::unique_ptr<mechanics::TissueFactor> tissue_factor, const std::vector<plan::FilmLayout>& films,
        const mechanics::FilmCells& cells, mechanics::TissueSystem& tissue_system, mechanics::FilmGeometry& geometry,
        const StaticLoad& load, const std::vector<Eigen::VectorXd>& entered)
      : pools(find_pools(films, cells, entered)),
        system(tissue_system),
        factor(std::move(tissue_factor)),
        balance(system, films, cells, pools, geometry, load),
        response(*factor, pools) {}
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  const Pools pools;
  mechanics::TissueSystem& system;
  const std::unique_ptr<mechanics::TissueFactor> factor;
  StaticBalance balance;
  HeldResponse response;
};

/// A shape that was found, and what for.
struct Found {
  Shape shape;  ///< no row: there is none
  PoolTarget target;
  Eigen::VectorXd springs;
};

}  // namespace lipofill::equilibrium
