// The factor that iterations go on with: exact where it was made, known to be late elsewhere, the
// same when taken up.

#include "core/mechanics/held_factor.h"

#include <Eigen/Cholesky>

#include "tests/unit/mechanics/small_system.h"

namespace lipofill::mechanics {
namespace {

TEST(HeldFactor, SolvesTheSystemOfItsPositions) {
  SmallSystem c;
  SimulationState state = c.state_at(c.bent(1e-3));
  ASSERT_TRUE(c.factor->renew(0.01, state));
  const Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(c.system->tissue().n_dofs(), -1.0, 2.0);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(c.system->gaps().volume().size());
  Eigen::VectorXd response, dx;
  c.factor->factor().solve_gap_response(force, response);
  c.factor->factor().solve_displacement(none, dx);
  const Eigen::MatrixXd s = Eigen::MatrixXd(c.system->tissue().system_matrix()).selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd exact = s.llt().solve(force);
  EXPECT_LT((dx - exact).norm(), 1e-4 * exact.norm());
  EXPECT_LT((response - c.system->gaps().derivative() * exact).norm(), 1e-4 * response.norm());
}

TEST(HeldFactor, KnowsWhichPositionsItIsOf) {
  SmallSystem c;
  SimulationState state = c.state_at(c.bent(1e-3));
  EXPECT_TRUE(HeldFactor::is_due(state)) << "nothing was factored yet";
  ASSERT_TRUE(c.factor->renew(0.01, state));
  EXPECT_FALSE(HeldFactor::is_due(state));
  EXPECT_FALSE(c.factor->is_late(state.positions));
  EXPECT_TRUE(c.factor->is_late(c.bent(0.9e-3)));
  EXPECT_EQ(c.factor->take_up(state), HeldFactor::TakenUp::kAtHand);
  EXPECT_EQ(c.cost.factorisations, 1);
  state.late_iterations = 6;
  EXPECT_TRUE(HeldFactor::is_due(state)) << "late iterations have cost as much as a factor";
}

TEST(HeldFactor, IsTakenUpToTheSameBits) {
  SmallSystem c;
  SimulationState kept = c.state_at(c.bent(1e-3));
  ASSERT_TRUE(c.factor->renew(0.01, kept));
  const Eigen::MatrixXd compliance = c.factor->factor().compliance();
  SimulationState other = c.state_at(c.bent(0.2e-3));
  ASSERT_TRUE(c.factor->renew(0.02, other));
  EXPECT_NE(c.factor->factor().compliance(), compliance);
  EXPECT_EQ(c.factor->take_up(kept), HeldFactor::TakenUp::kMade);
  EXPECT_EQ(c.factor->factor().compliance(), compliance);
}

}  // namespace
}  // namespace lipofill::mechanics
