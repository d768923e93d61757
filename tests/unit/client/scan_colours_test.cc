// Colours of a scan, out of every format that has them, found again on the skin of a result.

#include "client/cpp/scene/scan_colours.h"

#include <gmock/gmock.h>

#include "client/cpp/gltf/gltf_surface.h"
#include "temporary_folder.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

class ScanColoursTest : public TemporaryFolderTest {
 protected:
  void expect_colours(const std::filesystem::path& file, double mm) {
    const auto found = read_scan_colours(file, mm);
    ASSERT_TRUE(found.ok()) << found.status();
    ASSERT_EQ(found->points_mm.cols(), 3);
    EXPECT_NEAR((found->points_mm.col(1) - Eigen::Vector3d(100, 0, 0)).norm(), 0.0, 1e-4);
    EXPECT_NEAR((found->colours.col(0) - Eigen::Vector3f(1, 0, 0)).norm(), 0.0F, 1e-6F);
    EXPECT_NEAR(found->colours(1, 1), 128.0F / 255.0F, 1e-3F);
  }
};

TEST_F(ScanColoursTest, PlyAndObjHaveTheSame) {
  ColouredSurface surface;
  surface.points = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
  surface.triangles = {{0, 1, 2}};
  surface.colours = {{255, 0, 0}, {0, 128, 0}, {9, 9, 9}};
  expect_colours(write("a.ply", ply_bytes(surface, 1.0)), 1000.0);
  expect_colours(write("b.obj", "v 0 0 0 1 0 0\nv 100 0 0 0 0.50196 0\nv 0 100 0 0 0 0\nf 1 2 3\n"), 1.0);
  expect_colours(write("c.obj", "v 0 0 0 255 0 0\r\nv 10 0 0 0 128 0\r\nv 0 10 0 0 0 0\r\nf 1 2 3\r\n"), 10.0);
}

TEST_F(ScanColoursTest, FilesWithoutColoursAreRefused) {
  const auto refusal = [this](const std::string& name, const std::string& bytes) {
    return std::string(read_scan_colours(write(name, bytes), 1.0).status().message());
  };
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("a.obj: has no colours"));
  EXPECT_THAT(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n"),
              HasSubstr("a.ply: has no red"));
  EXPECT_THAT(refusal("a.stl", "solid"), HasSubstr("is not one of"));
  EXPECT_THAT(std::string(read_scan_colours(folder_ / "none.ply", 1.0).status().message()), HasSubstr("none.ply"));
}

TEST_F(ScanColoursTest, ThePointNearestGivesTheColour) {
  ColouredPoints scan;
  scan.points_mm.resize(3, 2);
  scan.points_mm << 4e6, 4e6 + 10, 0, 0, 0, 0;
  scan.colours.resize(3, 2);
  scan.colours << 1, 0, 0, 1, 0, 0;
  Eigen::Matrix3Xd skin(3, 2);
  skin << 4e6 + 9.5, 4e6 + 0.25, 0, 0, 0.25, 0;
  const auto colours = find_nearest_colours(scan, skin);
  ASSERT_TRUE(colours.ok()) << colours.status();
  EXPECT_EQ(colours->col(0), Eigen::Vector3f(0, 1, 0));
  EXPECT_EQ(colours->col(1), Eigen::Vector3f(1, 0, 0));
  const auto other = find_nearest_colours(scan, skin.array() + 500.0);
  EXPECT_THAT(std::string(other.status().message()), HasSubstr("2 of 2 points"));
}

}  // namespace
}  // namespace lipofill::client
