// The tissue and its gaps as functions of positions: derivatives against differences, and nothing
// stale.

#include "core/mechanics/tissue_system.h"

#include "tests/unit/mechanics/small_system.h"

namespace lipofill::mechanics {
namespace {

TEST(TissueSystem, BIsTheDerivativeOfTheGaps) {
  SmallSystem c;
  const Eigen::Matrix3Xd x = c.bent(1e-3);
  c.system->evaluate_gaps(x);
  const Eigen::SparseMatrix<double> b = c.system->gaps().derivative();
  const Eigen::VectorXd direction = Eigen::VectorXd::LinSpaced(c.system->tissue().n_dofs(), -1.0, 1.0);
  constexpr double kStep = 1e-7;
  Eigen::VectorXd difference = Eigen::VectorXd::Zero(b.rows());
  for (const double side : {1.0, -1.0}) {
    Eigen::Matrix3Xd moved = x;
    c.system->add_displacement(side * kStep * direction, moved);
    c.system->evaluate_gaps(moved);
    difference += side / (2.0 * kStep) * c.system->gaps().volume();
  }
  EXPECT_LT((b * direction - difference).norm(), 1e-7 * (b * direction).norm());
}

TEST(TissueSystem, ForcesAreThoseOfThePositionsLastAskedFor) {
  SmallSystem c;
  const Eigen::Matrix3Xd near = c.bent(0.5e-3), far = c.bent(1e-3);
  c.system->bring_forces_to(near, c.springs, 0.01);
  const Eigen::VectorXd of_near = c.system->tissue().internal_force();
  c.system->bring_forces_to(far, c.springs, 0.01);
  const Eigen::VectorXd of_far = c.system->tissue().internal_force();
  EXPECT_GT((of_far - of_near).norm(), 0.1 * of_near.norm());
  c.system->bring_forces_to(near, c.springs, 0.01);
  EXPECT_EQ(c.system->tissue().internal_force(), of_near) << "to the bit: a step may be tried again";
}

TEST(TissueSystem, AssemblingGivesTheSameForcesAsForcesAlone) {
  SmallSystem c;
  const Eigen::Matrix3Xd x = c.bent(1e-3);
  c.system->bring_forces_to(x, c.springs, 0.01);
  const Eigen::VectorXd alone = c.system->tissue().internal_force();
  c.system->assemble(x, c.springs, 0.01);
  EXPECT_EQ(c.system->tissue().internal_force(), alone);
}

TEST(TissueSystem, AZoneThatNoFreeNodeOpensIsRefused) {
  SmallSystem c;
  c.spec.films[0].zones = {{"thin", geometry::ChartBox{0.2, 0.4, 0.2, 0.4}}};
  c.spec.films[0].n_xi = c.spec.films[0].n_eta = 5;
  c.spec.films[0].edge.outline = plan::ZoneOutline::kCells;
  const auto film = plan::place_film(*c.model, c.spec.films[0]);
  ASSERT_TRUE(film.ok()) << film.status();
  const std::vector<plan::FilmLayout> films{*film};
  const auto made = TissueSystem::create(*c.model, films, number_cells(films), c.spec, c.cost);
  ASSERT_FALSE(made.ok());
  EXPECT_NE(std::string(made.status().ToString()).find("at least two cells wide"), std::string::npos) << made.status();
}

}  // namespace
}  // namespace lipofill::mechanics
