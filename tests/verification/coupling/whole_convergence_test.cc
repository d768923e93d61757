// Whole plans on finer and finer grids: lift, pressure and skin against the finest.

#include <gtest/gtest.h>

#include <filesystem>
#include <variant>

#include "core/geometry/default_size.h"
#include "tests/integration/faces/face_files.h"
#include "tests/verification/coupling/refined_plan.h"

namespace lipofill::verification {
namespace {

/// The divisions of a plan that leaves them open.
geometry::GridSize size_that_ships(const JawPlan& plan) {
  const auto model = model::build_face_model(plan.model, nullptr);
  EXPECT_TRUE(model.ok()) << model.status();
  if (!model.ok()) return {};
  return {(*model)->geometry.grid.n_xi, (*model)->geometry.grid.n_eta};
}

TEST(WholeConvergence, OfTheSamplePlanElastography) {
  const JawPlan plan = load_sample_plan("elastography.json");
  ASSERT_TRUE(plan.ok);
  record_refinement("elastography", plan, size_that_ships(plan), {0.5, 1.0, 2.0}, {});
}

/// The plan that leaves all sizes open, on a scan of a person.
TEST(WholeConvergence, OfARealFace) {
  const std::filesystem::path shared = LIPOFILL_SHARED_DATA;
  const lipofill::testing::FaceFile file{"james_face", shared / "james_face.ply", shared / "james_face.landmarks.json"};
  if (!std::filesystem::exists(file.surface)) GTEST_SKIP() << "there is no " << file.surface;
  JawPlan plan = load_sample_plan("jaw_contour.json");
  ASSERT_TRUE(plan.ok);
  std::get<geometry::ScanRegionSpec>(plan.model.region) = lipofill::testing::read_face_file(file);
  // From 0.7 to 1 the subcutaneous layer gets its second element: orders say little here.
  record_refinement("jaw_contour on a real face", plan, size_that_ships(plan), {0.5, 0.7071, 1.0, 1.4142},
                    {0.015, 0.03, RefinementBounds::kNoOrder});
}

}  // namespace
}  // namespace lipofill::verification
