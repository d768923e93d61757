// Series of DICOM: found, chosen, stacked by where their slices lie, or refused with the reason.

#include <gmock/gmock.h>

#include <fstream>

#include "dicom_fixture.h"

namespace lipofill::client {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void set(DcmDataset* data_set, const DcmTagKey& tag, const std::string& text) {
  TestSeries::put_text(data_set, tag, text);
}

class DicomSeriesTest : public DicomTest {
 protected:
  TestSeries series_;
  /// Writes the series into a folder of its own and gives what is said of it.
  std::string refusal_with(const EditSlice& edit) {
    series_.edit = edit;
    std::filesystem::remove_all(folder_ / "odd");
    series_.write(folder_ / "odd");
    return dicom_refusal_of("odd");
  }
  std::vector<std::string> remarks_of(const std::string& name) const {
    const auto dicom = read_dicom_volume(folder_ / name, {});
    EXPECT_TRUE(dicom.ok()) << dicom.status();
    return dicom.ok() ? dicom->volume.remarks : std::vector<std::string>();
  }
};

TEST_F(DicomSeriesTest, SlicesAreOrderedByTheirPlaces) {
  series_.write(folder_ / "ct");
  expect_ball_in("ct");
  EXPECT_THAT(remarks_of("ct"), IsEmpty());
}

TEST_F(DicomSeriesTest, FramesOfOneFile) {
  series_.write_frames(folder_ / "head.dcm");
  expect_ball_in("head.dcm");
  series_.edit = [](DcmDataset* data_set, int) {
    data_set->findAndDeleteElement(DCM_PerFrameFunctionalGroupsSequence);
  };
  series_.write_frames(folder_ / "lost.dcm");
  EXPECT_THAT(dicom_refusal_of("lost.dcm"), HasSubstr("has no ImagePositionPatient"));
}

TEST_F(DicomSeriesTest, ListsWhatThereIs) {
  series_.write(folder_ / "study" / "a");
  TestSeries other = series_;
  other.uid += ".7";
  other.number = 5;
  other.description = "Scout\x07";
  other.edit = [](DcmDataset* data_set, int) { set(data_set, DCM_Modality, "MR"); };
  other.write(folder_ / "study" / "b");
  write("study/readme.txt", "no DICOM");
  const auto listing = list_dicom(folder_ / "study");
  ASSERT_TRUE(listing.ok());
  ASSERT_EQ(listing->series.size(), 2U);
  EXPECT_EQ(listing->series[0].number, 2);
  EXPECT_EQ(listing->series[0].label(), "2 (CT, 40 x 36 x 32)");
  EXPECT_EQ(listing->series[0].stack.orientation, "axial");
  EXPECT_DOUBLE_EQ(listing->series[0].stack.slice_spacing, 1.5);
  EXPECT_EQ(listing->series[1].description, "Scout?");
  EXPECT_EQ(listing->patients, 1U);
  EXPECT_EQ(listing->other_files, 1U);
}

TEST_F(DicomSeriesTest, TakesTheLargestAxialCtOrTheOneNamed) {
  series_.write(folder_ / "ct");
  TestSeries larger = series_;
  larger.uid += ".1";
  larger.number = 3;
  larger.ball.size[2] = 40;
  larger.edit = [](DcmDataset* data_set, int) { set(data_set, DCM_Modality, "MR"); };
  larger.write(folder_ / "ct" / "mr");
  const auto chosen = read_dicom_volume(folder_ / "ct", {});
  ASSERT_TRUE(chosen.ok()) << chosen.status();
  EXPECT_EQ(chosen->series_number, 2);
  EXPECT_EQ(read_dicom_volume(folder_ / "ct", {.series = "3"})->modality, "MR");
  EXPECT_EQ(read_dicom_volume(folder_ / "ct", {.series = larger.uid})->size[2], 40U);
  EXPECT_THAT(dicom_refusal_of("ct", {.series = "9"}), HasSubstr("no series 9; there are 2 (CT, 40 x 36 x 32), 3 (MR"));
}

TEST_F(DicomSeriesTest, AGantryThatLeansShearsTheVolume) {
  // Each slice lies 0.1 mm further back than the one below, and shows what is there.
  series_.edit = [this](DcmDataset* data_set, int k) {
    BallVolume moved = series_.ball;
    moved.centre[1] -= 0.1 * k;
    const auto voxels = moved.voxels();
    std::vector<uint16_t> pixels;
    const size_t size = 40 * 36;
    for (size_t i = 0; i < size; ++i)
      pixels.push_back(static_cast<uint16_t>(voxels[size * static_cast<size_t>(k) + i] + 1024));
    data_set->putAndInsertUint16Array(DCM_PixelData, pixels.data(), size);
    set(data_set, DCM_ImagePositionPatient, absl::StrFormat("5\\%g\\%g", 6 + 0.1 * k, 7 + 1.5 * k));
  };
  series_.write(folder_ / "ct");
  expect_ball_in("ct");
  EXPECT_THAT(remarks_of("ct"), Contains(HasSubstr("leans by 3.8 degrees")));
}

TEST_F(DicomSeriesTest, UnevenSlicesStayWhereTheyAre) {
  // Above the middle only every other slice was taken: the ball is the same but for the chords
  // between slices of 3 mm, 3^2 / (8 R) = 0.08 mm.
  series_.write(folder_ / "ct");
  for (int k = 17; k < 32; k += 2) std::filesystem::remove(folder_ / "ct" / absl::StrFormat("IM%04d", (k * 7) % 32));
  const auto skin = extract("ct");
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_NEAR(skin->bounds_mm[4], 31 - 14, 0.03);
  EXPECT_NEAR(skin->bounds_mm[5], 31 + 14, 0.2);
  EXPECT_THAT(remarks_of("ct"), Contains(HasSubstr("slices lie 1.50 to 3.00 mm apart")));
}

TEST_F(DicomSeriesTest, MissingSlicesAreNamedOrBridged) {
  series_.write(folder_ / "ct");
  for (const int k : {15, 16}) std::filesystem::remove(folder_ / "ct" / absl::StrFormat("IM%04d", (k * 7) % 32));
  const std::string said = dicom_refusal_of("ct");
  EXPECT_THAT(said, HasSubstr("4.50 mm lie between the slices at 28.00 and 32.50 mm"));
  EXPECT_THAT(said, HasSubstr("about 2 of 32 missing"));
  EXPECT_THAT(said, HasSubstr("--bridge-gaps"));
  const auto skin = extract("ct", {.series = "", .bridge_gaps = true});
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_NEAR(skin->bounds_mm[4], 31 - 14, 0.03);
  EXPECT_NEAR(skin->bounds_mm[5], 31 + 14, 0.03);
}

TEST_F(DicomSeriesTest, RescalesOfSlicesDiffer) {
  series_.edit = [this](DcmDataset* data_set, int k) {
    if (k % 2 == 0) return;
    auto pixels = series_.stored_pixels();
    const size_t size = 40 * 36, begin = size * static_cast<size_t>(k);
    for (size_t i = 0; i < size; ++i) pixels[begin + i] = static_cast<uint16_t>(2 * pixels[begin + i]);
    data_set->putAndInsertUint16Array(DCM_PixelData, pixels.data() + begin, size);
    set(data_set, DCM_RescaleSlope, "0.5");
  };
  series_.write(folder_ / "ct");
  expect_ball_in("ct");
}

TEST_F(DicomSeriesTest, PaddingIsAirAndForeignBitsAreNot) {
  series_.edit = [this](DcmDataset* data_set, int k) {
    auto pixels = series_.stored_pixels();
    const size_t size = 40 * 36, begin = size * static_cast<size_t>(k);
    for (size_t i = 0; i < size; ++i) {
      uint16_t& pixel = pixels[begin + i];
      // Outside the circle of reconstruction nothing was measured; an overlay uses the high bits.
      if (pixel == 24 && i % 3 == 0) pixel = 4000;
      pixel = static_cast<uint16_t>(pixel | (i % 2 == 0 ? 0xF000 : 0));
    }
    data_set->putAndInsertUint16Array(DCM_PixelData, pixels.data() + begin, size);
    data_set->putAndInsertUint16(DCM_PixelPaddingValue, 4000);
  };
  series_.write(folder_ / "ct");
  expect_ball_in("ct");
}

TEST_F(DicomSeriesTest, LocalizersAndCopiesAreLeftOut) {
  series_.write(folder_ / "ct");
  std::filesystem::copy_file(folder_ / "ct" / "IM0003", folder_ / "ct" / "copy");
  TestSeries scout = series_;
  scout.uid = series_.uid;
  scout.edit = [](DcmDataset* data_set, int) {
    set(data_set, DCM_ImageType, "ORIGINAL\\PRIMARY\\LOCALIZER");
    set(data_set, DCM_SOPInstanceUID, "1.2.3");
    set(data_set, DCM_ImageOrientationPatient, "1\\0\\0\\0\\0\\-1");
  };
  scout.write_slice(0, folder_ / "ct" / "scout");
  expect_ball_in("ct");
  const auto remarks = remarks_of("ct");
  EXPECT_THAT(remarks, Contains("1 images are localizers and were left out"));
  EXPECT_THAT(remarks, Contains("1 images are there twice and were taken once"));
}

TEST_F(DicomSeriesTest, RefusesWhatIsNoVolume) {
  EXPECT_THAT(refusal_with([](DcmDataset* d, int k) {
                if (k == 20) set(d, DCM_PatientID, "4711b");
              }),
              HasSubstr("images of 2 patients"));
  EXPECT_THAT(dicom_refusal_of("odd", {.series = "2"}), HasSubstr("more than one patient"));
  EXPECT_THAT(refusal_with([](DcmDataset* d, int k) {
                if (k > 20) set(d, DCM_ImageOrientationPatient, "1\\0\\0\\0\\0\\-1");
              }),
              HasSubstr("mixed orientations"));
  EXPECT_THAT(refusal_with([](DcmDataset* d, int) { set(d, DCM_PixelSpacing, "0\\1"); }),
              HasSubstr("PixelSpacing 0 mm, not in (0.001, 100)"));
  EXPECT_THAT(refusal_with([](DcmDataset* d, int) { set(d, DCM_RescaleSlope, "0"); }), HasSubstr("RescaleSlope 0"));
  EXPECT_THAT(refusal_with([](DcmDataset* d, int k) {
                if (k == 8) set(d, DCM_ImagePositionPatient, absl::StrFormat("5\\6\\%g", 7 + 1.5 * 9));
              }),
              HasSubstr("two of its images lie at the same place"));
  EXPECT_THAT(refusal_with([](DcmDataset* d, int) { d->findAndDeleteElement(DCM_ImagePositionPatient); }),
              HasSubstr("a secondary capture?): export the original images"));
  EXPECT_THAT(refusal_with([](DcmDataset* d, int) { d->putAndInsertUint16(DCM_SamplesPerPixel, 3); }),
              HasSubstr("has 3 samples a pixel"));
  EXPECT_THAT(refusal_with([](DcmDataset* d, int k) {
                if (k == 3) d->putAndInsertUint16(DCM_Rows, 18);
              }),
              HasSubstr("different sizes"));
  EXPECT_THAT(refusal_with([](DcmDataset* d, int) { set(d, DCM_ImageOrientationPatient, "1\\0\\0\\1\\0\\0"); }),
              HasSubstr("not two unit vectors at right angles"));
}

TEST_F(DicomSeriesTest, RefusesTwoPatientsUnlessTheSeriesIsNamed) {
  series_.write(folder_ / "both" / "a");
  TestSeries other = series_;
  other.patient = "4712";
  other.uid += ".3";
  other.number = 8;
  other.write(folder_ / "both" / "b");
  EXPECT_THAT(dicom_refusal_of("both"), HasSubstr("images of 2 patients"));
  expect_ball_in("both", {.series = "8"});
}

TEST_F(DicomSeriesTest, ATruncatedFileIsNamed) {
  series_.write(folder_ / "ct");
  const auto file = folder_ / "ct" / "IM0005";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 700);
  EXPECT_THAT(dicom_refusal_of("ct"), HasSubstr("IM0005, is cut short or damaged: copy or export it again"));
}

TEST_F(DicomSeriesTest, AFolderWithoutImagesSaysWhatItHolds) {
  std::filesystem::create_directories(folder_ / "none");
  write("none/empty.dcm", "");
  write("none/encrypted.dcm", std::string(4000, '\x5a'));
  EXPECT_THAT(dicom_refusal_of("none"), HasSubstr("holds no DICOM image: 2 files are no DICOM"));
  EXPECT_THAT(dicom_refusal_of("nowhere"), HasSubstr("does not exist"));
  series_.write_slice(3, folder_ / "one.dcm");
  EXPECT_THAT(dicom_refusal_of("one.dcm"), HasSubstr("it has 1 slice"));
}

}  // namespace
}  // namespace lipofill::client
