#include "core/planning/nearest_grid.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/planning/test_heads.h"

namespace lipofill::planning {
namespace {

SurfaceSamples make_samples(int n) {
  return sample_surface(*extract_skin(make_uneven_head(), "the head"), n);
}

TEST(NearestGrid, FindsTheNearestSampleToACubesWidth) {
  const SurfaceSamples samples = make_samples(2000);
  const double cell = 0.004;
  const NearestGrid grid(samples, cell, 0.03);
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> spread(-0.1, 0.1);
  for (int k = 0; k < 500; ++k) {
    const Eigen::Vector3d point(spread(generator), spread(generator), spread(generator));
    const int found = grid.find(point);
    ASSERT_GE(found, 0);
    const double nearest = std::sqrt((samples.points.colwise() - point).colwise().squaredNorm().minCoeff());
    EXPECT_LE((samples.points.col(found) - point).norm(), nearest + 2.0 * cell);
  }
}

TEST(NearestGrid, KnowsNothingOutside) {
  const NearestGrid grid(make_samples(100), 0.004, 0.03);
  EXPECT_EQ(grid.find({0.2, 0.0, 0.0}), -1);
  EXPECT_EQ(grid.find({0.0, 0.0, std::numeric_limits<double>::quiet_NaN()}), -1);
}

}  // namespace
}  // namespace lipofill::planning
