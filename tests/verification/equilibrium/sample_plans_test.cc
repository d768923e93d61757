// Sample plans found directly, against the same plans stepped until next to nothing is left to go.

#include <gtest/gtest.h>

#include <string>

#include "tests/verification/coupling/jaw_case.h"
#include "tests/verification/equilibrium/direct_case.h"
#include "tests/verification/record.h"

namespace lipofill::verification {
namespace {

/// The stepped plan has so far to go when it is compared [m].
constexpr double kLeft = 1e-6;

double largest(const Eigen::Matrix3Xd& difference) {
  return difference.colwise().norm().maxCoeff();
}

class SamplePlan : public ::testing::TestWithParam<std::string> {};

TEST_P(SamplePlan, FoundDirectlyIsTheOneThatStepsComeTo) {
  const JawPlan plan = load_sample_plan(GetParam() + ".json");
  ASSERT_TRUE(plan.ok);
  const auto model = model::build_face_model(plan.model, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  DirectCase direct(*model, plan.simulation);
  const equilibrium::PoolTarget target = direct.target();
  const equilibrium::Settled settled = direct.solve();
  ASSERT_TRUE(settled.is_whole()) << settled.reason;
  const auto stepped = step_until_at_rest(*model, plan.simulation, kLeft);
  ASSERT_NE(stepped, nullptr);
  const double off = 1e3 * largest(direct.skin(settled) - skin_of(*stepped));
  const double lost = (settled.pool_volume - target.volume).cwiseAbs().maxCoeff() / target.volume.maxCoeff();

  Case settled_case({"coupled/8-settled-directly", "Settled shapes of sample plans, found directly",
                     "The same plans in time steps until the skin has 0.001 mm left to go."});
  settled_case.record({GetParam() + ": largest difference of the skin", "mm", 3e-3, off, 0.0, Bound::kAtMost});
  settled_case.record({GetParam() + ": volumes of pools, share off", "1", 1e-12, lost, 0.0, Bound::kAtMost});
  settled_case.record(
      {GetParam() + ": factors", "1", 3.0, static_cast<double>(settled.cost.factors), 0.0, Bound::kAtMost});
  settled_case.record(
      {GetParam() + ": iterations", "1", 12.0, static_cast<double>(settled.cost.iterations), 0.0, Bound::kAtMost});
}

INSTANTIATE_TEST_SUITE_P(Every, SamplePlan, ::testing::Values("square", "jaw_angle", "two_planes", "elastography"),
                         [](const auto& info) { return info.param; });

/// Four times the fat of the plan, 18 mL below a skin of 4 mm: in parts where it does not go in at
/// once.
TEST(LargeLoad, ComesToItsShapeOrSaysHowFarItGoes) {
  JawPlan plan = load_jaw_plan();
  ASSERT_TRUE(plan.ok);
  for (plan::InjectionSpec& injection : plan.simulation.injections) injection.volume *= 4.0;
  const auto model = model::build_face_model(plan.model, nullptr);
  ASSERT_TRUE(model.ok()) << model.status();
  DirectCase direct(*model, plan.simulation);
  const equilibrium::Settled settled = direct.solve();
  std::printf("share %g, %d factors, %d iterations, %zu closed: %s\n", settled.share, settled.cost.factors,
              settled.cost.iterations, settled.closed.size(), settled.reason.c_str());
  EXPECT_GT(settled.share, 0.5);
  EXPECT_EQ(settled.is_whole(), settled.reason.empty());
  EXPECT_LE(settled.force_error, 1e-3);
  EXPECT_LT((settled.pool_volume - settled.fat_volume).cwiseAbs().maxCoeff(), 1e-12 * settled.fat_volume.sum());
}

}  // namespace
}  // namespace lipofill::verification
