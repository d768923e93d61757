// What the grid makes of a forecast's nominal shape: the estimate of two grids where a third shows
// that the order holds, and a mark where it does not.

#include "core/forecast/grid_error.h"

#include <gmock/gmock.h>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::forecast {
namespace {

using ::testing::HasSubstr;

/// The small plate on n x n hexahedra.
absl::StatusOr<GridError> error_on(int n) {
  model::FaceModelSpec model_spec = simulation::make_small_model_spec();
  model_spec.n_xi = model_spec.n_eta = n;
  const auto model = model::build_face_model(model_spec, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  plan::SimulationSpec plan = simulation::make_small_plan();
  plan.films[0].n_xi = plan.films[0].n_eta = n / 2;
  return estimate_grid_error(*model, plan);
}

TEST(GridError, FallsOnAFinerGridWithItsOrder) {
  const auto coarse = error_on(24);
  const auto fine = error_on(48);
  ASSERT_TRUE(coarse.ok()) << coarse.status();
  ASSERT_TRUE(fine.ok()) << fine.status();
  EXPECT_LT(fine->lift, coarse->lift);
  EXPECT_LT(fine->pressure, coarse->pressure);
  ASSERT_TRUE(fine->lift_order && fine->pressure_order);
  EXPECT_TRUE(fine->order_holds) << *fine->lift_order << " " << *fine->pressure_order;
  EXPECT_EQ(remark_on_order(*fine), "");
}

TEST(GridError, IsMarkedWhereTheOrderIsNotKnown) {
  const auto error = error_on(16);
  ASSERT_TRUE(error.ok()) << error.status();
  EXPECT_FALSE(error->lift_order) << "8 divisions cannot be halved";
  EXPECT_FALSE(error->order_holds);
  EXPECT_THAT(remark_on_order(*error), HasSubstr("lift: order not known"));
  EXPECT_GT(error->lift, 0.0);
}

TEST(GridError, SaysWhyThereIsNone) {
  const auto error = error_on(8);
  EXPECT_EQ(error.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(error.status().message()), HasSubstr("too few divisions"));
}

}  // namespace
}  // namespace lipofill::forecast
