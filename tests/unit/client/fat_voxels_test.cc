// Films in voxels: volumes are kept, slices lie where they lie, and another frame is noticed.

#include "client/cpp/records/fat_voxels.h"

#include <gmock/gmock.h>

#include "records_fixture.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

class FatVoxelsTest : public RecordsTest {
 protected:
  DicomStack stack() const { return study().series->stack; }
};

size_t count(const FatVoxels& fat) {
  size_t labelled = 0;
  for (const auto& [slice, pixels] : fat.slices)
    labelled += static_cast<size_t>(std::count(pixels.begin(), pixels.end(), 1));
  return labelled;
}

TEST_F(FatVoxelsTest, ASlabThatFillsVoxelsIsThoseVoxels) {
  const auto fat = find_fat_voxels(slab(15.5, 25.5, 24.125, 34.125, 30.25, 3), stack());
  ASSERT_TRUE(fat.ok()) << fat.status();
  // Slices lie at 7 + 1.5 k mm: the two from 28.75 to 31.75 mm are k = 15 and 16. Columns lie at
  // 5 + i mm, rows at 6 + 1.25 j mm.
  ASSERT_EQ(fat->slices.size(), 2U);
  EXPECT_EQ(fat->slices.begin()->first, 15U);
  EXPECT_EQ(count(*fat), 10U * 8U * 2U);
  const std::vector<uint8_t>& pixels = fat->slices.begin()->second;
  EXPECT_EQ(pixels[15 * 40 + 11], 1);
  EXPECT_EQ(pixels[15 * 40 + 10], 0);
  EXPECT_EQ(pixels[14 * 40 + 11], 0);
  EXPECT_EQ(pixels[22 * 40 + 20], 1);
  EXPECT_NEAR(fat->film_ml, 0.3, 1e-9);
  EXPECT_NEAR(fat->voxels_ml, 0.3, 1e-9);
}

TEST_F(FatVoxelsTest, ASlantedSlabKeepsItsVolume) {
  const auto fat = find_fat_voxels(slab(12.3, 31.1, 17.7, 38.9, 30.4, 4.3, 0.6), stack());
  ASSERT_TRUE(fat.ok()) << fat.status();
  const double area = 18.8 * 21.2 * std::hypot(1.0, 0.6);
  EXPECT_NEAR(fat->film_ml, area * 4.3 / 1000, 1e-6);
  EXPECT_NEAR(fat->voxels_ml / fat->film_ml, 1.0, 0.05);
}

TEST_F(FatVoxelsTest, AFilmThinnerThanHalfAVoxelLabelsNothing) {
  const auto fat = find_fat_voxels(slab(15, 25, 24, 34, 31, 0.05), stack());
  ASSERT_TRUE(fat.ok()) << fat.status();
  EXPECT_TRUE(fat->slices.empty());
  EXPECT_NEAR(fat->film_ml, 0.005, 1e-6);
}

TEST_F(FatVoxelsTest, SlicesThatLieUnevenlyKeepTheirPlaces) {
  series_.edit = [](DcmDataset* data_set, int k) {
    // From slice 10 on they are 2 mm apart.
    const double z = k <= 10 ? 7 + 1.5 * k : 22 + 2.0 * (k - 10);
    TestSeries::put_text(data_set, DCM_ImagePositionPatient, absl::StrFormat("5\\6\\%g", z));
    TestSeries::put_text(data_set, DCM_FrameOfReferenceUID, kFrame);
  };
  series_.write(folder_ / "ct");
  const auto fat = find_fat_voxels(slab(15.5, 25.5, 24.125, 34.125, 35, 4), stack());
  ASSERT_TRUE(fat.ok()) << fat.status();
  EXPECT_EQ(fat->slices.begin()->first, 16U);
  EXPECT_EQ(fat->slices.size(), 2U);
  EXPECT_NEAR(fat->voxels_ml, 0.4, 1e-9);
}

TEST_F(FatVoxelsTest, ASurfaceLiesInTheSeriesOrInPart) {
  EXPECT_EQ(find_share_outside(slab(15, 25, 24, 34, 31, 3), stack()), 0.0);
  EXPECT_EQ(find_share_outside(slab(-15, 25, 24, 34, 31, 3), stack()), 0.5);
}

TEST_F(FatVoxelsTest, FatOutsideOfTheSeriesIsAnotherFrame) {
  const auto fat = find_fat_voxels(slab(-25.5, -15.5, 24, 34, 31, 3), stack());
  ASSERT_FALSE(fat.ok());
  EXPECT_THAT(std::string(fat.status().message()), HasSubstr("0.300 of 0.300 mL of fat lie outside of the series"));
}

}  // namespace
}  // namespace lipofill::client
