#include "core/coupling/pressure_solver.h"

#include "tests/unit/coupling/pressure_case.h"

namespace lipofill::coupling {
namespace {

constexpr int kFew = 7;
constexpr int kMany = 14;
static_assert(kFew * kFew <= PressureSolver::kMaxDirectCells && kMany * kMany > PressureSolver::kMaxDirectCells);

void expect_solved(PressureCase& pressure_case, PressureSolver& solver, const std::vector<char>& held, double bound) {
  const Eigen::VectorXd r = 1e-9 * Eigen::VectorXd::Random(pressure_case.n);
  const Eigen::VectorXd p = Eigen::VectorXd::Zero(pressure_case.n);
  Eigen::VectorXd dp, moved;
  ASSERT_TRUE(solver.solve(p, held, r, 1e-10 * r.cwiseAbs().maxCoeff(), dp, moved));
  pressure_case.expect_solution(held, r, dp, moved, bound);
}

TEST(PressureSolver, BeforeItHasWallsItHasDoneNothing) {
  PressureCase tissue(kFew);
  const PressureSolver solver({&tissue.projection});
  EXPECT_FALSE(solver.is_lagged());
  EXPECT_EQ(solver.iterative_solves() + solver.iterations() + solver.fallbacks(), 0);
}

TEST(PressureSolver, FewCellsAreSolvedAtOnce) {
  PressureCase tissue(kFew);
  PressureSolver solver({&tissue.projection});
  solver.set_walls(tissue.walls);
  ASSERT_FALSE(solver.is_lagged());
  tissue.take_thickness(1e-3, 0.01);
  expect_solved(tissue, solver, tissue.hold_every_fifth(), 1e-11);
  EXPECT_EQ(solver.iterative_solves(), 0);
}

TEST(PressureSolver, ManyCellsAreSolvedByIterations) {
  PressureCase tissue(kMany);
  PressureSolver solver({&tissue.projection});
  solver.set_walls(tissue.walls);
  ASSERT_TRUE(solver.is_lagged());
  solver.renew_preconditioner({tissue.take_thickness(1e-3, 0.01)});
  expect_solved(tissue, solver, tissue.hold_none(), 1e-4);
  EXPECT_EQ(solver.iterative_solves(), 1);
  EXPECT_GT(solver.iterations(), 0);
  EXPECT_EQ(solver.fallbacks(), 0);
}

TEST(PressureSolver, NewWallsOfTheSameKindAreTakenUp) {
  PressureCase springs(kFew);
  PressureSolver solver({&springs.projection});
  springs.take_thickness(1e-3, 0.01);
  springs.walls.dense = nullptr;
  for (const double stiffness : {1e6, 3e6}) {
    springs.walls.diagonal = springs.metric.area / stiffness;
    springs.c = springs.walls.diagonal.asDiagonal();
    solver.set_walls(springs.walls);
    expect_solved(springs, solver, springs.hold_none(), 1e-11);
  }
}

}  // namespace
}  // namespace lipofill::coupling
