#include "core/planning/registration.h"

#include <gmock/gmock.h>

#include <cstring>

#include "core/planning/landmark_start.h"
#include "tests/unit/planning/test_heads.h"

namespace lipofill::planning {
namespace {

using ::testing::HasSubstr;

geometry::Landmarks move_landmarks(geometry::Landmarks landmarks, const RigidMotion& motion) {
  for (auto& [name, position] : landmarks) position = motion.apply(position);
  return landmarks;
}

Registration register_without_landmarks(const geometry::SurfaceMesh& moving, const geometry::SurfaceMesh& fixed) {
  const SkinSurface moving_skin = *extract_skin(moving, "a");
  const SkinSurface fixed_skin = *extract_skin(fixed, "b");
  return *register_surface({moving_skin, fixed_skin, {}, {}});
}

TEST(Registration, FindsAPartInAnyPose) {
  const geometry::SurfaceMesh head = make_uneven_head();
  const RigidMotion pose = make_pose();
  const geometry::SurfaceMesh part = move_surface(cut_away(head, {0.3, 1.0, -0.4}, 0.3), pose);
  const Registration found = register_without_landmarks(part, head);
  EXPECT_TRUE(check_registration(found, "it").ok()) << check_registration(found, "it");
  EXPECT_LT(compare_motions(found.motion, pose.inverse(), part.points), 1e-5);
  EXPECT_EQ(found.start, RegistrationStart::kShape);
  EXPECT_GT(found.confidence, 0.5);
  const Registration again = register_without_landmarks(part, head);
  EXPECT_EQ(std::memcmp(&again.motion, &found.motion, sizeof(RigidMotion)), 0) << "the same bytes";
  const Registration back = register_without_landmarks(head, part);
  EXPECT_LT(compare_motions(back.motion, pose, head.points), 1e-5) << "also the larger onto the smaller";
}

TEST(Registration, StartsFromLandmarks) {
  const geometry::SurfaceMesh head = make_uneven_head();
  const RigidMotion pose = make_pose();
  geometry::Landmarks marks = move_landmarks(make_landmarks(head), pose);
  marks["zygion_left"] += Eigen::Vector3d(0.004, -0.003, 0.002);
  const SkinSurface moving = *extract_skin(move_surface(head, pose), "a");
  const SkinSurface fixed = *extract_skin(head, "b");
  const auto found = register_surface({moving, fixed, marks, make_landmarks(head)});
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->start, RegistrationStart::kLandmarks);
  EXPECT_LT(compare_motions(found->motion, pose.inverse(), moving.mesh.points), 1e-5);
}

TEST(Registration, RefusesLandmarksOfSwappedSides) {
  const geometry::SurfaceMesh head = make_uneven_head();
  geometry::Landmarks swapped = make_landmarks(head);
  for (const char* name : {"exocanthion", "cheilion", "zygion", "gonion", "tragion"}) {
    std::swap(swapped[std::string(name) + "_left"], swapped[std::string(name) + "_right"]);
  }
  const auto start = align_landmarks(swapped, make_landmarks(head));
  EXPECT_THAT(std::string(start.status().message()), HasSubstr("left and right are swapped"));
}

TEST(Registration, RefusesTheMirrorImage) {
  const geometry::SurfaceMesh head = make_uneven_head();
  const Registration found = register_without_landmarks(move_surface(reflect(head, {}), make_pose()), head);
  EXPECT_EQ(found.confidence, 0.0);
  EXPECT_THAT(std::string(check_registration(found, "it").message()), HasSubstr("left and right are swapped"));
}

TEST(Registration, RefusesAnotherHead) {
  std::vector<Bump> bumps = symmetric_bumps();
  for (Bump& bump : bumps) bump.width *= 1.5, bump.height *= -0.6;
  const Registration found = register_without_landmarks(make_head(bumps), make_uneven_head());
  EXPECT_THAT(std::string(check_registration(found, "the surface").message()), HasSubstr("fit within 1 mm"));
}

TEST(Registration, RefusesWhatHasNoPlace) {
  geometry::SurfaceMesh ball = make_head({});
  ball.points.colwise().normalize();
  ball.points *= 0.09;
  const Registration found = register_without_landmarks(ball, ball);
  const absl::Status checked = check_registration(found, "the surface");
  EXPECT_THAT(std::string(checked.message()), ::testing::AnyOf(HasSubstr("known to"), HasSubstr("another placement")));
}

TEST(Registration, MeasuresWhatLiesThereAlready) {
  const geometry::SurfaceMesh head = make_uneven_head();
  const SkinSurface skin = *extract_skin(head, "a");
  const SkinSurface moved = *extract_skin(move_surface(head, {Eigen::Matrix3d::Identity(), {0, 0, 0.012}}), "b");
  EXPECT_TRUE(check_registration(measure_in_place(skin, skin), "it").ok());
  EXPECT_FALSE(check_registration(measure_in_place(moved, skin), "it").ok());
}

TEST(Registration, EndsWhenItIsUnwanted) {
  const SkinSurface skin = *extract_skin(make_uneven_head(), "a");
  EXPECT_TRUE(absl::IsCancelled(register_surface({skin, skin, {}, {}}, [] { return true; }).status()));
}

}  // namespace
}  // namespace lipofill::planning
