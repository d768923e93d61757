// The same as tissue_volume_test.cc on the curved cheek of the sample face.

#include "tests/verification/coupling/jaw_case.h"
#include "tests/verification/coupling/tissue_volume.h"
#include "tests/verification/film/film_cases.h"

namespace lipofill::verification {
namespace {

TEST(TissueVolume, IsKeptOnACurvedCheek) {
  const JawPlan plan = load_sample_plan("elastography.json");
  ASSERT_TRUE(plan.ok);
  expect_volume_kept(plan.model, "cheek");
}

}  // namespace
}  // namespace lipofill::verification
