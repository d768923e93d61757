#include "core/planning/target.h"

#include <gmock/gmock.h>

#include <cstring>

#include "core/base/field_violations.h"
#include "core/planning/deficit.h"
#include "tests/unit/planning/test_heads.h"

namespace lipofill::planning {
namespace {

using ::testing::HasSubstr;

geometry::SurfaceMesh make_sunken_head() {
  std::vector<Bump> bumps = symmetric_bumps();
  bumps.push_back({{0.75, -0.35, 0.4}, 0.25, -0.005});
  return make_head(bumps);
}

// The left cheek has sunk in: the right one, mirrored, is the even head again.
TEST(Target, OfTheHealthySideFillsTheSickOne) {
  const geometry::SurfaceMesh sunken = make_sunken_head();
  const geometry::Landmarks landmarks = make_landmarks(make_even_head());
  const auto target = make_mirrored_target({sunken, landmarks}, FaceSide::kRight);
  ASSERT_TRUE(target.ok()) << target.status();
  const auto mirrored = measure_deficit({sunken, target->surface, landmarks, 0.0});
  const geometry::SurfaceMesh even = make_even_head();
  const auto known = measure_deficit({sunken, even, landmarks, 0.0});
  ASSERT_TRUE(mirrored.ok() && known.ok());
  EXPECT_NEAR(mirrored->all.volume.deficit / known->all.volume.deficit, 1.0, 0.03);
  const auto again = make_mirrored_target({sunken, landmarks}, FaceSide::kRight);
  EXPECT_TRUE(again->surface.points == target->surface.points) << "the same bytes";
}

TEST(Target, OfASwappedFaceIsRefusedByField) {
  geometry::Landmarks swapped = make_landmarks(make_even_head());
  for (const char* name : {"exocanthion", "cheilion", "zygion", "gonion", "tragion"}) {
    std::swap(swapped[std::string(name) + "_left"], swapped[std::string(name) + "_right"]);
  }
  const auto target = make_mirrored_target({make_even_head(), swapped}, FaceSide::kRight);
  const auto violations = field_violations_of(target.status());
  ASSERT_FALSE(violations.empty()) << target.status();
  EXPECT_EQ(violations[0].field, "landmarks_mm");
}

TEST(Target, FromElsewhereKeepsItsVertices) {
  const geometry::SurfaceMesh head = make_uneven_head();
  const geometry::SurfaceMesh moved = move_surface(head, make_pose());
  const auto target = make_surface_target({head, {}}, {moved, {}}, SurfacePlacement::kRegistered);
  ASSERT_TRUE(target.ok()) << target.status();
  EXPECT_LT((target->surface.points - head.points).colwise().norm().maxCoeff(), 1e-5);
  EXPECT_EQ(target->surface.triangles, moved.triangles);
  const auto in_place = make_surface_target({head, {}}, {moved, {}}, SurfacePlacement::kInPlace);
  EXPECT_THAT(std::string(in_place.status().message()), HasSubstr("cannot be placed"));
}

}  // namespace
}  // namespace lipofill::planning
