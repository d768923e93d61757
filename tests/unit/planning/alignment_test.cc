#include "core/planning/alignment.h"

#include <gtest/gtest.h>

#include "tests/unit/planning/test_heads.h"

namespace lipofill::planning {
namespace {

RigidMotion make_small_motion() {
  return turn_about({0.01, 0.02, 0.03}, Eigen::Vector3d(0.05, -0.06, 0.04), {0.004, -0.003, 0.002});
}

TEST(Alignment, FindsTheWayBack) {
  const SkinSurface skin = *extract_skin(make_uneven_head(), "the head");
  const SurfaceSamples samples = sample_surface(skin, 1500);
  const RigidMotion found = align_samples(samples, ExactMatcher(skin), make_small_motion(), {0.02, 0.005, 60, 1e-8});
  EXPECT_LT(compare_motions(found, RigidMotion{}, samples.points), 1e-7);
}

// A fifth of the face stands 8 mm out, as after an operation.
TEST(Alignment, IsNotMovedByWhatWasOperatedOn) {
  const SkinSurface skin = *extract_skin(make_uneven_head(), "the head");
  SurfaceSamples samples = sample_surface(skin, 1500);
  for (Eigen::Index k = 0; k < samples.size(); ++k) {
    if (samples.points(0, k) > 0.03) samples.points.col(k) += 0.008 * samples.normals.col(k);
  }
  const RigidMotion found = align_samples(samples, ExactMatcher(skin), make_small_motion(), {0.02, 0.004, 60, 1e-8});
  EXPECT_LT(compare_motions(found, RigidMotion{}, samples.points), 5e-5);
}

TEST(Alignment, FitCountsWhatLiesOverTheSkin) {
  const SkinSurface whole = *extract_skin(make_uneven_head(), "the head");
  const SkinSurface half = *extract_skin(cut_away(make_uneven_head(), {0, 1, 0}, 0.5), "half");
  const Fit fit = measure_fit(sample_surface(whole, 2000), ExactMatcher(half), RigidMotion{}, 0.01);
  EXPECT_NEAR(fit.overlap(), half.area / whole.area, 0.03) << "what is beyond the border does not count";
  EXPECT_DOUBLE_EQ(fit.share_within(1e-4), 1.0);
  const Fit none =
      measure_fit(sample_surface(whole, 100), ExactMatcher(half), {Eigen::Matrix3d::Identity(), {1, 0, 0}}, 0.01);
  EXPECT_EQ(none.over, 0);
  EXPECT_EQ(none.share_within(1.0), 0.0);
}

TEST(Alignment, KnowsWhatItCannotTell) {
  const SkinSurface head = *extract_skin(make_uneven_head(), "the head");
  const SkinSurface ball = *extract_skin(
      [] {
        geometry::SurfaceMesh sphere = make_head({});
        sphere.points.colwise().normalize();
        sphere.points *= 0.09;
        return sphere;
      }(),
      "the ball");
  const auto error_of = [](const SkinSurface& skin) {
    return assess_certainty(sample_surface(skin, 1500), ExactMatcher(skin), RigidMotion{}, 0.01).expected_error;
  };
  EXPECT_LT(error_of(head), 1e-4);
  EXPECT_GT(error_of(ball), 1e-3) << "a ball may be turned as one likes";
}

}  // namespace
}  // namespace lipofill::planning
