// Whole plans on finer and finer grids: lift, pressure and skin against the finest.

#include <gtest/gtest.h>

#include <filesystem>
#include <variant>

#include "core/geometry/default_size.h"
#include "tests/integration/faces/face_files.h"
#include "tests/verification/coupling/refined_plan.h"

namespace lipofill::verification {
namespace {

TEST(WholeConvergence, OfTheSamplePlanElastography) {
  const JawPlan plan = load_sample_plan("elastography.json");
  ASSERT_TRUE(plan.ok);
  // Its grid of 2.1 mm was chosen before the attachments of 4 mm that it has to resolve.
  record_refinement("elastography", plan, {plan.model.n_xi, plan.model.n_eta}, {0.5, 1.0, 2.0}, {0.03, 0.08, 0.9});
}

/// The plan that leaves all sizes open, on a scan of a person.
TEST(WholeConvergence, OfARealFace) {
  const std::filesystem::path shared = LIPOFILL_SHARED_DATA;
  const lipofill::testing::FaceFile file{"james_face", shared / "james_face.ply", shared / "james_face.landmarks.json"};
  if (!std::filesystem::exists(file.surface)) GTEST_SKIP() << "there is no " << file.surface;
  JawPlan plan = load_sample_plan("jaw_contour.json");
  ASSERT_TRUE(plan.ok);
  std::get<geometry::ScanRegionSpec>(plan.model.region) = lipofill::testing::read_face_file(file);
  const auto ships = model::build_face_model(plan.model, nullptr);
  ASSERT_TRUE(ships.ok()) << ships.status();
  const geometry::LayeredGrid& grid = (*ships)->geometry.grid;
  // From 0.7 to 1 the subcutaneous layer gets its second element: orders say little here.
  record_refinement("jaw_contour on a real face", plan, {grid.n_xi, grid.n_eta}, {0.5, 0.7071, 1.0, 1.4142},
                    {0.015, 0.03, RefinementBounds::kNoOrder});
}

}  // namespace
}  // namespace lipofill::verification
