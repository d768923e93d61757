// Cook's membrane of nearly incompressible neo-Hookean tissue at finite strain: E = 3, plane
// strain, a dead shear load of 0.05 a unit length on the right side. Reference: deflection of the
// corner (48, 60), incompressible, 4.7011 (B. Mueller, Mixed least squares finite element methods
// based on inverse stress-strain relations in hyperelasticity, thesis, Universitaet Duisburg-Essen
// 2015).

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/solid/box_mesh.h"
#include "tests/verification/record.h"
#include "tests/verification/solid/static_solver.h"

namespace lipofill::solid::testing {
namespace {

using verification::Case;

constexpr double kPublished = 4.7011;
constexpr double kTraction = 0.05;

double corner_deflection(int n) {
  const PointMap taper = [](const Eigen::Vector3d& s) {
    const double bottom = 44.0 * s[0];
    const double top = 44.0 + 16.0 * s[0];
    return Eigen::Vector3d(48.0 * s[0], bottom + (top - bottom) * s[1], s[2]);
  };
  const Box box{{n, n, 1}, {1, 1, 1}, true, taper};
  Tissue tissue = Tissue::create(box.make(), {{3.0, 0.4999, 1.0, 0.0, TissueLaw::kNeoHookean}}, {}, {}).value();
  LargeDeformation problem{{}, tissue.mesh().rest_positions, Eigen::Matrix3Xd::Zero(3, box.n_nodes())};
  problem.held.resize(box.n_nodes());
  for_each_node(box, [&](int a, int i, int j, int) {
    problem.held[a] = {i == 0, i == 0, true};
    const bool end = j == 0 || j == n;
    if (i == n) problem.force(1, a) = kTraction * 16.0 * (end ? 0.5 : 1.0) / (2.0 * n);
  });
  const StaticState state = solve_large_deformation(tissue, problem, 4);
  EXPECT_TRUE(state.converged);
  const int corner = box.node(n, n, 0);
  return state.x(1, corner) - tissue.mesh().rest_positions(1, corner);
}

/// The corner's singularity keeps the order near 1.
TEST(NeoHookeanCookMembrane, BendsAsPublished) {
  Case cook({"solid/11d-neo-hookean-cook", "Cook's membrane of incompressible neo-Hookean tissue",
             "Corner deflection at E = 3, traction 0.05, of B. Mueller's thesis (Duisburg-Essen 2015)."});
  const std::vector<double> sizes = {8, 16, 32};
  std::vector<double> errors;
  for (const double n : sizes) errors.push_back(corner_deflection(static_cast<int>(n)) / kPublished - 1.0);
  cook.record({"corner deflection, 32 x 32", "1", kPublished, kPublished * (1.0 + errors[2]), 0.01});
  cook.record_series({"corner deflection", "elements a side", sizes, errors, 1.0, 0.7});
}

}  // namespace
}  // namespace lipofill::solid::testing
