// Colours of vertices, in every way that files write them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "core/geometry/surface_reader.h"

namespace lipofill::geometry {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr Rgb8 kRed = {255, 0, 0};
constexpr Rgb8 kGreen = {0, 128, 0};
constexpr Rgb8 kGrey = {9, 9, 9};
constexpr Rgb8 kSkin = {222, 179, 153};

ScannedSurface read(const std::string& bytes, SurfaceFormat format) {
  auto surface = read_surface(bytes, format, 1e-3);
  EXPECT_TRUE(surface.ok()) << surface.status();
  return surface.ok() ? *std::move(surface) : ScannedSurface{};
}

/// A triangle whose vertices have `first`, `second` and `third` behind their place.
std::string obj_of(const std::string& first, const std::string& second, const std::string& third) {
  return absl::StrCat("v 0 0 0", first, "\nv 100 0 0", second, "\nv 0 100 0", third, "\nf 1 2 3\n");
}

std::string ply_of(const std::string& type, const std::string& names, const std::string& body) {
  std::string header = "ply\nformat ascii 1.0\nelement vertex 3\n";
  for (const char* axis : {"x", "y", "z"}) absl::StrAppend(&header, "property float ", axis, "\n");
  for (const char& letter : names) {
    absl::StrAppend(&header, "property ", type, " ", letter == 'r' ? "red" : letter == 'g' ? "green" : "blue", "\n");
  }
  return absl::StrCat(header, "element face 1\nproperty list uchar int vertex_indices\nend_header\n", body,
                      "3 0 1 2\n");
}

TEST(SurfaceColours, OfObjGoFromZeroToOneOrTo255) {
  EXPECT_THAT(read(obj_of(" 1 0 0", " 0 0.50196 0", " .0353 .0353 .0353"), SurfaceFormat::kObj).colours,
              ElementsAre(kRed, kGreen, kGrey));
  EXPECT_THAT(read(obj_of(" 255 0 0", " 0 128 0", " 9 9 9"), SurfaceFormat::kObj).colours,
              ElementsAre(kRed, kGreen, kGrey));
  // Four numbers have how opaque the vertex is behind them.
  EXPECT_THAT(read(obj_of(" 1 0 0 1", " 0 0.50196 0 1", " .0353 .0353 .0353 1"), SurfaceFormat::kObj).colours,
              ElementsAre(kRed, kGreen, kGrey));
}

TEST(SurfaceColours, AWeightOrAWordBehindAPlaceIsNone) {
  EXPECT_THAT(read(obj_of(" 1", " 1.0", " 0.5"), SurfaceFormat::kObj).colours, IsEmpty());
  EXPECT_THAT(read(obj_of(" # a 1 2", " nan 0 0", ""), SurfaceFormat::kObj).colours, IsEmpty());
}

TEST(SurfaceColours, OfPlyHaveTheRangeOfTheirType) {
  const std::string bytes = "0 0 0 255 0 0\n100 0 0 0 128 0\n0 100 0 9 9 9\n";
  EXPECT_THAT(read(ply_of("uchar", "rgb", bytes), SurfaceFormat::kPly).colours, ElementsAre(kRed, kGreen, kGrey));
  const std::string words = "0 0 0 65535 0 0\n100 0 0 0 32896 0\n0 100 0 2313 2313 2313\n";
  EXPECT_THAT(read(ply_of("ushort", "rgb", words), SurfaceFormat::kPly).colours, ElementsAre(kRed, kGreen, kGrey));
  const std::string shares = "0 0 0 1 0 0\n100 0 0 0 0.50196 0\n0 100 0 .0353 .0353 .0353\n";
  EXPECT_THAT(read(ply_of("float", "rgb", shares), SurfaceFormat::kPly).colours, ElementsAre(kRed, kGreen, kGrey));
  // A dark face of bytes is dark, though no number is above 1.
  const std::string dark = "0 0 0 1 1 1\n100 0 0 0 0 0\n0 100 0 1 0 0\n";
  EXPECT_THAT(read(ply_of("uchar", "rgb", dark), SurfaceFormat::kPly).colours,
              ElementsAre(Rgb8{1, 1, 1}, Rgb8{0, 0, 0}, Rgb8{1, 0, 0}));
}

TEST(SurfaceColours, AFewThatAreTooBrightDoNotDarkenTheOthers) {
  std::string bytes = "v 0 0 0 1.004 0 0\nv 100 0 0 7 0.50196 1e30\n";
  for (int k = 0; k < 300; ++k) absl::StrAppend(&bytes, "v ", k, " 100 0 1 0 0\nf 1 2 ", k + 3, "\n");
  const auto surface = read(bytes, SurfaceFormat::kObj);
  ASSERT_EQ(surface.colours.size(), 302u);
  EXPECT_EQ(surface.colours[0], kRed);
  EXPECT_EQ(surface.colours[1], (Rgb8{255, 128, 255}));
  EXPECT_EQ(surface.colours.back(), kRed);
}

TEST(SurfaceColours, ThreeMakeOne) {
  EXPECT_THAT(read(ply_of("uchar", "rg", "0 0 0 255 0\n100 0 0 0 128\n0 100 0 9 9\n"), SurfaceFormat::kPly).colours,
              IsEmpty());
}

TEST(SurfaceColours, StayWithTheirVerticesWhereOthersAreLeftOut) {
  const auto surface =
      read("v 5 5 5 0 0 1\nv 0 0 0 1 0 0\nv 100 0 0 0 .50196 0\nv 0 100 0 .0353 .0353 .0353\nf 2 3 4\n",
           SurfaceFormat::kObj);
  EXPECT_THAT(surface.colours, ElementsAre(kRed, kGreen, kGrey));
}

TEST(SurfaceColours, VerticesWithoutOneGetThatOfSkinAndAreSaid) {
  const auto surface = read(obj_of(" 1 0 0", "", " .0353 .0353 .0353"), SurfaceFormat::kObj);
  EXPECT_THAT(surface.colours, ElementsAre(kRed, kSkin, kGrey));
  EXPECT_THAT(surface.remarks, Contains(HasSubstr("1 vertex has no colour")));
  // One behind the last colour, and numbers that are none.
  const auto tail = read(obj_of(" 1 0 0", " 0 .50196 0", ""), SurfaceFormat::kObj);
  EXPECT_THAT(tail.colours, ElementsAre(kRed, kGreen, kSkin));
  const auto wild =
      read(ply_of("float", "rgb", "0 0 0 nan 0 0\n100 0 0 -4 0.50196 0\n0 100 0 1 0 0\n"), SurfaceFormat::kPly);
  EXPECT_THAT(wild.colours, ElementsAre(kSkin, kGreen, kRed));
}

}  // namespace
}  // namespace lipofill::geometry
