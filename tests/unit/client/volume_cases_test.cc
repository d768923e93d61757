// Volumes that were read wrongly once, from ../shared: the head phantom in every one.

#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <string>

#include "client/cpp/volume/skin_extraction.h"
#include "temporary_folder.h"

namespace lipofill::client {
namespace {

class VolumeCases : public TemporaryFolderTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(VolumeCases, ShowTheHeadPhantom) {
  const std::filesystem::path file = std::filesystem::path(LIPOFILL_SHARED_DATA) / "reader_cases" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "there is no " << file;
  const auto skin = extract_skin(file, folder_ / "skin.ply", SkinExtraction{.isovalue = -300.0});
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_EQ(skin->frame, "LPS");
  constexpr std::array<double, 6> kBounds{-31.0, 41.4, -51.7, 37.2, -45.4, 57.5};
  // Where air is not a number, neither are the voxels that it fills in part: the edge lies
  // somewhere in a voxel of 1.5 x 1.6 x 2 mm.
  const double bound = std::string(GetParam()) == "nifti_nan_background.nii" ? 1.6 : 0.06;
  for (size_t k = 0; k < 6; ++k) EXPECT_NEAR(skin->bounds_mm[k], kBounds[k], bound) << "bound " << k;
}

INSTANTIATE_TEST_SUITE_P(Shared, VolumeCases,
                         ::testing::Values("nifti_gzip_two_members.nii.gz", "nifti_int64.nii.gz", "metaimage_long.mha",
                                           "nifti2.nii", "nifti_nan_background.nii", "nifti_negative_pixdim.nii",
                                           "nifti_slope_nan.nii", "nifti_units_micrometre.nii",
                                           "nrrd_keyvalue_named_type.nrrd", "nrrd_unsigned_short_int.nrrd",
                                           "metaimage_4d_of_one.mha"),
                         [](const auto& each) {
                           std::string name = each.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace lipofill::client
