#include "core/anatomy/regions.h"

#include <gtest/gtest.h>

#include "core/base/field_violations.h"

namespace lipofill::anatomy {
namespace {

TEST(Regions, EveryNameExistsOnBothSides) {
  for (const std::string& name : region_names()) {
    for (const std::string side : {"_left", "_right"}) {
      const auto region = find_region(name + side);
      ASSERT_TRUE(region.ok()) << name + side;
      EXPECT_GT(region->half_length, region->half_width * 0.5);
      for (const auto& [landmark, weight] : region->centre.weights) {
        const bool has_a_side = landmark.ends_with("_left") || landmark.ends_with("_right");
        EXPECT_TRUE(!has_a_side || landmark.ends_with(side)) << landmark;
        EXPECT_GT(weight, 0.0);
      }
    }
  }
}

TEST(Regions, AnUnknownNameListsTheKnownOnes) {
  for (const char* name : {"masseter", "elbow_left", "", "_left"}) {
    const auto region = find_region(name);
    ASSERT_FALSE(region.ok());
    EXPECT_NE(std::string(region.status().message()).find("mandibular_angle"), std::string::npos);
  }
}

TEST(Regions, AnEllipseHoldsWhatLiesWithinItsAxes) {
  const PlacedRegion region{{1.0, 2.0, 3.0}, {1.0, 0.0, 0.0}, 0.02, 0.01};
  EXPECT_TRUE(region.contains({1.0, 2.0, 3.0}));
  EXPECT_TRUE(region.contains({1.0199, 2.0, 3.0}));
  EXPECT_FALSE(region.contains({1.0201, 2.0, 3.0}));
  EXPECT_TRUE(region.contains({1.0, 2.0099, 3.0}));
  EXPECT_FALSE(region.contains({1.0, 2.0101, 3.0}));
  EXPECT_FALSE(region.contains({1.015, 2.0, 3.008}));
}

TEST(Regions, ASquareHasNoLandmarksToPlaceThemBy) {
  geometry::FaceGeometrySpec spec;
  spec.region = geometry::SquareSpec{0.05, 0.05};
  spec.n_xi = spec.n_eta = 4;
  const auto face = geometry::build_face_geometry(spec, nullptr);
  ASSERT_TRUE(face.ok());
  EXPECT_EQ(place_region(*face, "masseter_left").status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace lipofill::anatomy
