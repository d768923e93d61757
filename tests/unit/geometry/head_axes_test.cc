#include "core/geometry/head_axes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/geometry/scalar_field.h"

namespace lipofill::geometry {
namespace {

using ::testing::HasSubstr;

/// A face in its own axes, then turned with its axes as one.
Landmarks make_landmarks(const Eigen::Matrix3d& turn) {
  const Landmarks upright = {{"nasion", {0.0, 0.09, 0.107}},
                             {"menton", {0.0, -0.024, 0.1015}},
                             {"exocanthion_left", {0.048, 0.083, 0.082}},
                             {"exocanthion_right", {-0.048, 0.083, 0.082}},
                             {"gonion_left", {0.057, 0.011, 0.032}},
                             {"gonion_right", {-0.057, 0.011, 0.032}}};
  Landmarks turned;
  for (const auto& [name, p] : upright) turned[name] = turn * p;
  return turned;
}

TEST(HeadAxes, FollowTheHead) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const auto axes = estimate_head_axes(make_landmarks(turn));
  ASSERT_TRUE(axes.ok()) << axes.status();
  EXPECT_GT(axes->left.dot(turn.col(0)), 0.9999);
  EXPECT_GT(axes->up.dot(turn.col(1)), 0.9999);
  EXPECT_GT(axes->forward.dot(turn.col(2)), 0.9999);
  EXPECT_LT((axes->up.cross(axes->forward) - axes->left).norm(), 1e-12);
}

TEST(HeadAxes, SayWhichLandmarksAreMissing) {
  Landmarks landmarks = make_landmarks(Eigen::Matrix3d::Identity());
  Landmarks one_sided = landmarks;
  one_sided.erase("gonion_right");
  one_sided.erase("exocanthion_right");
  EXPECT_THAT(std::string(estimate_head_axes(one_sided).status().message()), HasSubstr("both sides"));
  landmarks.erase("nasion");
  const auto axes = estimate_head_axes(landmarks);
  EXPECT_EQ(axes.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(axes.status().message()), HasSubstr("nasion"));
}

TEST(HeadAxes, RefuseLandmarksThatCoincide) {
  Landmarks landmarks;
  for (const char* name : {"nasion", "menton", "gonion_left", "gonion_right"}) landmarks[name].setZero();
  EXPECT_FALSE(estimate_head_axes(landmarks).ok());
}

TEST(ScalarField, IsBilinearAndHoldsItsEdges) {
  const ScalarField field{3, 2, {0, 1, 4, 10, 11, 14}};
  ASSERT_TRUE(field.validate().ok());
  EXPECT_DOUBLE_EQ(field.at(0.25, 0.5), 5.5);
  EXPECT_DOUBLE_EQ(field.at(1.0, 1.0), 14.0);
  EXPECT_DOUBLE_EQ(field.at(2.0, -1.0), 4.0);
  EXPECT_DOUBLE_EQ(field.minimum(), 0.0);
  EXPECT_DOUBLE_EQ(field.maximum(), 14.0);
  EXPECT_DOUBLE_EQ(ScalarField::constant(7).at(0.3, 0.9), 7.0);
  EXPECT_DOUBLE_EQ((ScalarField{1, 2, {1, 3}}.at(0.9, 0.5)), 2.0);
}

TEST(ScalarField, RefusesBadShapesAndValues) {
  EXPECT_FALSE((ScalarField{2, 2, {1, 2, 3}}.validate().ok()));
  EXPECT_FALSE((ScalarField{0, 1, {}}.validate().ok()));
  EXPECT_FALSE((ScalarField{5000, 1, std::vector<double>(5000, 1.0)}.validate().ok()));
  EXPECT_FALSE((ScalarField{1, 1, {std::nan("")}}.validate().ok()));
}

}  // namespace
}  // namespace lipofill::geometry
