// The factor of the tissue alone: it solves with what it was made of, whatever was factored before.

#include "core/mechanics/tissue_factor.h"

#include <Eigen/Cholesky>
#include <limits>

#include "tests/unit/mechanics/small_system.h"

namespace lipofill::mechanics {
namespace {

TEST(TissueFactor, SolvesWithTheStiffnessOfItsPositions) {
  SmallSystem c;
  auto factor = TissueFactor::create(*c.model, *c.system, c.cost);
  ASSERT_TRUE(factor.ok()) << factor.status();
  ASSERT_TRUE((*factor)->factor_at(c.bent(1e-3), c.springs));
  EXPECT_FALSE((*factor)->is_double());
  const Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(c.system->tissue().n_dofs(), -1.0, 2.0);
  Eigen::VectorXd x;
  (*factor)->solve(force, x);
  c.system->assemble(c.bent(1e-3), c.springs, std::numeric_limits<double>::infinity());
  const Eigen::MatrixXd s = Eigen::MatrixXd(c.system->tissue().system_matrix()).selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd exact = s.llt().solve(force);
  EXPECT_LT((x - exact).norm(), 1e-4 * exact.norm());
}

/// Equal positions give equal bits, whatever lay between.
TEST(TissueFactor, ForgetsWhatWasFactoredBefore) {
  SmallSystem c;
  auto factor = TissueFactor::create(*c.model, *c.system, c.cost);
  ASSERT_TRUE(factor.ok()) << factor.status();
  const Eigen::VectorXd force = Eigen::VectorXd::LinSpaced(c.system->tissue().n_dofs(), -1.0, 2.0);
  Eigen::VectorXd first, between, again;
  ASSERT_TRUE((*factor)->factor_at(c.bent(1e-3), c.springs));
  (*factor)->solve(force, first);
  ASSERT_TRUE((*factor)->factor_at(c.bent(0.2e-3), c.springs));
  (*factor)->solve(force, between);
  ASSERT_TRUE((*factor)->factor_at(c.bent(1e-3), c.springs));
  (*factor)->solve(force, again);
  EXPECT_NE(first, between);
  EXPECT_EQ(first, again);
}

}  // namespace
}  // namespace lipofill::mechanics
