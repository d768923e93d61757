#include "client/cpp/landmarks_file.h"

#include <gmock/gmock.h>

#include "temporary_folder.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

using LandmarksFileTest = TemporaryFolderTest;

TEST_F(LandmarksFileTest, ReadsTheObjectNamedAfterTheHash) {
  const std::string file =
      write("a.json", R"({"landmarks": {"nasion": [1, 2, 3]}, "before": {"menton": [4, 5, 6]}})").string();
  const auto plain = load_landmarks(file, v1::MILLIMETRE);
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_EQ(plain->points_mm.at("nasion"), (Point{1, 2, 3}));
  EXPECT_FALSE(plain->axes.has_value());
  const auto named = load_landmarks(file + "#before", v1::MILLIMETRE);
  ASSERT_TRUE(named.ok());
  EXPECT_EQ(named->points_mm.at("menton"), (Point{4, 5, 6}));
  EXPECT_THAT(std::string(load_landmarks(file + "#after", v1::MILLIMETRE).status().message()),
              HasSubstr("no object \"after\""));
}

TEST_F(LandmarksFileTest, UnitsOfTheFileGoBeforeThoseOfTheScan) {
  const std::string metres = write("m.json", R"({"landmarks": {"a": [0.01, 0, 0]}})").string();
  EXPECT_DOUBLE_EQ(load_landmarks(metres, v1::METRE)->points_mm.at("a")[0], 10.0);
  const std::string named = write("mm.json", R"({"units": "mm", "landmarks": {"a": [10, 0, 0]}})").string();
  EXPECT_DOUBLE_EQ(load_landmarks(named, v1::METRE)->points_mm.at("a")[0], 10.0);
  EXPECT_THAT(std::string(load_landmarks(write("x.json", R"({"units": "inch", "landmarks": {}})").string(), v1::METRE)
                              .status()
                              .message()),
              HasSubstr("\"inch\""));
}

TEST_F(LandmarksFileTest, NamesTheEntryThatIsNoPoint) {
  for (const auto& [text, named] : {std::pair{R"({"landmarks": {"a": [1, 2]}})", "landmarks.a is not [x, y, z]"},
                                    {R"({"landmarks": {"a": [1, 2, "3"]}})", "landmarks.a[2] is not a number"},
                                    {R"({"landmarks": {"a": null}})", "landmarks.a"},
                                    {R"({"landmarks": [1]})", "no object"},
                                    {R"({"landmarks": {}, "axes": {"left": [1, 0, 0]}})", "axes has no \"up\""}}) {
    const auto landmarks = load_landmarks(write("bad.json", text).string(), v1::MILLIMETRE);
    EXPECT_EQ(landmarks.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(std::string(landmarks.status().message()), HasSubstr(named));
  }
}

TEST(UpOf, ComesFromTheAxesOrTheMidline) {
  v1::ScanRegion region;
  EXPECT_FALSE(up_of(region).has_value());
  (*region.mutable_landmarks_mm())["nasion"].set_z(100);
  (*region.mutable_landmarks_mm())["menton"].set_z(10);
  EXPECT_EQ(*up_of(region), (Point{0, 0, 90}));
  region.mutable_axes()->mutable_up()->set_y(1);
  EXPECT_EQ(*up_of(region), (Point{0, 1, 0}));
}

TEST_F(LandmarksFileTest, ReadsTheSharedFaces) {
  const std::filesystem::path shared = LIPOFILL_SHARED_DATA;
  if (!std::filesystem::exists(shared)) GTEST_SKIP() << "no real faces at " << shared;
  const auto before = load_landmarks((shared / "lps_patient.json#landmarks_before").string(), v1::MILLIMETRE);
  ASSERT_TRUE(before.ok()) << before.status();
  EXPECT_DOUBLE_EQ(before->points_mm.at("gonion_left")[0], 49.308);
  const auto james = load_landmarks((shared / "james_face.landmarks.json").string(), v1::MILLIMETRE);
  ASSERT_TRUE(james.ok());
  EXPECT_TRUE(james->axes.has_value());
}

}  // namespace
}  // namespace lipofill::client
