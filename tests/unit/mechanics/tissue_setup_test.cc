// How the nodes of a model are held: a base that gives in part.

#include "core/mechanics/tissue_setup.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::mechanics {
namespace {

/// The small square, on a base of 2 kPa/mm that gives as said.
model::FaceModel make_model(const Eigen::VectorXd& give) {
  model::FaceModel model = *simulation::make_small_model();
  model.rim.kind = model::SupportKind::kFree;
  model.base = {model::SupportKind::kByRegion, 2e6};
  model.base_give = give;
  return model;
}

TEST(TissueSetup, ABaseOfFullGiveIsTheElasticBase) {
  const int n = simulation::make_small_model()->geometry.grid.nodes_per_level();
  const solid::NodeSupports by_give = hold_mesh(make_model(Eigen::VectorXd::Ones(n)), {}).supports;
  model::FaceModel elastic = make_model({});
  elastic.base = {model::SupportKind::kElastic, 2e6};
  const solid::NodeSupports given = hold_mesh(elastic, {}).supports;
  ASSERT_EQ(by_give.spring.size(), given.spring.size());
  double sum = 0.0;
  for (size_t node = 0; node < given.spring.size(); ++node) {
    EXPECT_DOUBLE_EQ(by_give.spring[node], given.spring[node]);
    sum += by_give.spring[node];
  }
  EXPECT_NEAR(sum, 2e6 * 0.048 * 0.048, 1e-6) << "stiffness times area [N/m]";
}

TEST(TissueSetup, HalfTheGiveIsTwiceTheStiffnessAndNoneIsBone) {
  const std::shared_ptr<const model::FaceModel> small = simulation::make_small_model();
  const geometry::LayeredGrid& grid = small->geometry.grid;
  Eigen::VectorXd give = Eigen::VectorXd::Constant(grid.nodes_per_level(), 0.5);
  for (int j = 0; j <= grid.n_eta; ++j) give[grid.surface_index(0, j)] = 0.0;
  const HeldMesh held = hold_mesh(make_model(give), {});
  const int deep = (grid.n_levels() - 1) * grid.nodes_per_level();
  const int bone = held.split.inner_node[deep + grid.surface_index(0, 5)];
  const int soft = held.split.inner_node[deep + grid.surface_index(6, 5)];
  EXPECT_TRUE(held.supports.fixed[bone][0] && held.supports.fixed[bone][2]);
  EXPECT_FALSE(held.supports.fixed[soft][2]);
  EXPECT_DOUBLE_EQ(held.supports.spring[soft], 2e6 / 0.5 * 0.004 * 0.004);
}

}  // namespace
}  // namespace lipofill::mechanics
