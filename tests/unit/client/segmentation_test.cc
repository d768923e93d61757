// DICOM segmentations as label maps.

#include "client/cpp/dicom/segmentation.h"

#include <gmock/gmock.h>

#include "client/cpp/dicom/any_volume.h"
#include "dicom_fixture.h"

namespace lipofill::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

/// A segmentation of the ball of test_dicom.h: its half to the right of the middle is "Mandible",
/// the other half segment 2, whose type is adipose tissue. Frames come from the top down, and those
/// without a voxel are left out.
class TestSegmentation {
 public:
  std::string type = "BINARY";
  E_TransferSyntax syntax = EXS_LittleEndianExplicit;
  std::string between = "1.5";
  std::function<void(DcmDataset*)> edit = [](DcmDataset*) {};

  void write(const std::filesystem::path& file) const {
    DcmFileFormat format;
    DcmDataset* const data_set = format.getDataset();
    const BallVolume ball;
    const bool is_map = type == "LABELMAP";
    std::vector<std::vector<uint8_t>> frames;
    for (int segment = 1; segment <= (is_map ? 1 : 2); ++segment) {
      for (int k = ball.size[2]; k-- > 0;) {
        auto pixels = plane(ball, k, is_map ? 0 : segment);
        if (std::all_of(pixels.begin(), pixels.end(), [](uint8_t pixel) { return pixel == 0; })) continue;
        put_frame(data_set, static_cast<int>(frames.size()), k, segment);
        frames.push_back(std::move(pixels));
      }
    }
    put_common(data_set, static_cast<int>(frames.size()), ball);
    put_pixels(data_set, frames);
    edit(data_set);
    DcmRLEEncoderRegistration::registerCodecs();
    if (data_set->chooseRepresentation(syntax, nullptr).bad() || format.saveFile(file.c_str(), syntax).bad())
      throw std::runtime_error("DCMTK does not write " + file.string());
  }

 private:
  static std::vector<uint8_t> plane(const BallVolume& ball, int k, int segment) {
    std::vector<uint8_t> pixels;
    const auto values = ball.voxels();
    const size_t area = static_cast<size_t>(ball.size[0] * ball.size[1]);
    for (size_t at = 0; at < area; ++at) {
      const int label = values[area * static_cast<size_t>(k) + at] < -500 ? 0 : at % 40 <= 20 ? 1 : 2;
      pixels.push_back(static_cast<uint8_t>(segment == 0 ? label : label == segment ? 1 : 0));
    }
    return pixels;
  }

  static DcmItem* item_of(DcmItem* parent, const DcmTagKey& sequence, int number) {
    DcmItem* item = nullptr;
    parent->findOrCreateSequenceItem(sequence, item, number);
    return item;
  }

  void put_frame(DcmDataset* data_set, int frame, int k, int segment) const {
    DcmItem* const groups = item_of(data_set, DCM_PerFrameFunctionalGroupsSequence, frame);
    TestSeries::put_text(item_of(groups, DCM_PlanePositionSequence, 0), DCM_ImagePositionPatient,
                         absl::StrFormat("5\\6\\%g", 7.0 + 1.5 * k));
    if (type == "LABELMAP") return;
    item_of(groups, DCM_SegmentIdentificationSequence, 0)
        ->putAndInsertUint16(DCM_ReferencedSegmentNumber, static_cast<Uint16>(segment));
  }

  void put_common(DcmDataset* data_set, int frames, const BallVolume& ball) const {
    for (const auto& [tag, text] : {std::pair{DCM_SOPClassUID, UID_SegmentationStorage},
                                    {DCM_SOPInstanceUID, "1.2.3.4"},
                                    {DCM_PatientName, "JANE^SECRET"},
                                    {DCM_PatientID, "4711"},
                                    {DCM_Modality, "SEG"},
                                    {DCM_SeriesInstanceUID, "1.2.3"},
                                    {DCM_SeriesNumber, "7"},
                                    {DCM_PhotometricInterpretation, "MONOCHROME2"}})
      TestSeries::put_text(data_set, tag, text);
    TestSeries::put_text(data_set, DCM_SegmentationType, type);
    TestSeries::put_text(data_set, DCM_NumberOfFrames, std::to_string(frames));
    if (type == "FRACTIONAL") data_set->putAndInsertUint16(DCM_MaximumFractionalValue, 200);
    const int bits = type == "BINARY" ? 1 : 8;
    for (const auto& [tag, value] : {std::pair{DCM_Rows, ball.size[1]},
                                     {DCM_Columns, ball.size[0]},
                                     {DCM_SamplesPerPixel, 1},
                                     {DCM_BitsAllocated, bits},
                                     {DCM_BitsStored, bits},
                                     {DCM_HighBit, bits - 1},
                                     {DCM_PixelRepresentation, 0}})
      data_set->putAndInsertUint16(tag, static_cast<Uint16>(value));
    DcmItem* const shared = item_of(data_set, DCM_SharedFunctionalGroupsSequence, 0);
    TestSeries::put_text(item_of(shared, DCM_PlaneOrientationSequence, 0), DCM_ImageOrientationPatient,
                         "1\\0\\0\\0\\1\\0");
    DcmItem* const measures = item_of(shared, DCM_PixelMeasuresSequence, 0);
    TestSeries::put_text(measures, DCM_PixelSpacing, "1.25\\1");
    if (!between.empty()) TestSeries::put_text(measures, DCM_SpacingBetweenSlices, between);
    for (int segment = 1; segment <= 2; ++segment) {
      DcmItem* const item = item_of(data_set, DCM_SegmentSequence, segment - 1);
      item->putAndInsertUint16(DCM_SegmentNumber, static_cast<Uint16>(segment));
      TestSeries::put_text(item, DCM_SegmentLabel, segment == 1 ? "Mandible" : "Segment 2");
      TestSeries::put_text(item_of(item, DCM_SegmentedPropertyTypeCodeSequence, 0), DCM_CodeMeaning,
                           segment == 1 ? "Mandible" : "Adipose tissue");
    }
  }

  void put_pixels(DcmDataset* data_set, const std::vector<std::vector<uint8_t>>& frames) const {
    std::vector<uint8_t> bytes;
    size_t bit = 0;
    for (const auto& frame : frames) {
      for (const uint8_t pixel : frame) {
        if (type != "BINARY") {
          bytes.push_back(type == "FRACTIONAL" ? static_cast<uint8_t>(pixel * 100) : pixel);
          continue;
        }
        if (bit % 8 == 0) bytes.push_back(0);
        if (pixel != 0) bytes.back() = static_cast<uint8_t>(bytes.back() | 1 << bit % 8);
        ++bit;
      }
    }
    if (bytes.size() % 2 == 1) bytes.push_back(0);
    data_set->putAndInsertUint8Array(DCM_PixelData, bytes.data(), bytes.size());
  }
};

class SegmentationTest : public DicomTest {
 protected:
  /// The bounds of what a label has, half a voxel beyond the middles of its outermost voxels.
  std::array<double, 6> bounds_of(const Volume& volume, const char* label) {
    SkinExtraction options;
    options.labels = {label};
    options.all_components = true;
    const auto surface = extract_skin(volume, "seg.dcm", folder_ / "label.ply", options);
    EXPECT_TRUE(surface.ok()) << surface.status();
    return surface.ok() ? surface->bounds_mm : std::array<double, 6>{};
  }

  void expect_halves(const Volume& volume) {
    const std::array<double, 3> radius{14, 14, 14};
    for (const char* label : {"all", "Mandible", "fat"}) {
      const auto bounds = bounds_of(volume, label);
      const bool right = label[0] == 'M', left = label[0] == 'f';
      EXPECT_NEAR(bounds[0], left ? 5 + 20.5 : kCentre[0] - radius[0], 0.8) << label;
      EXPECT_NEAR(bounds[1], right ? 5 + 20.5 : kCentre[0] + radius[0], 0.8) << label;
      EXPECT_NEAR(bounds[4], kCentre[2] - radius[2], 1.1) << label;
      EXPECT_NEAR(bounds[5], kCentre[2] + radius[2], 1.1) << label;
    }
  }

  std::string refusal(const TestSegmentation& segmentation) {
    segmentation.write(folder_ / "bad.dcm");
    const auto volume = read_segmentation(folder_ / "bad.dcm");
    EXPECT_FALSE(volume.ok());
    const std::string said(volume.status().message());
    EXPECT_EQ(said.find("SECRET"), std::string::npos) << said;
    EXPECT_EQ(said.find("4711"), std::string::npos) << said;
    return said;
  }
};

TEST_F(SegmentationTest, EachTypeIsALabelMapWithNames) {
  for (const char* type : {"BINARY", "FRACTIONAL", "LABELMAP"}) {
    TestSegmentation segmentation;
    segmentation.type = type;
    segmentation.write(folder_ / "seg.dcm");
    EXPECT_TRUE(is_segmentation(folder_ / "seg.dcm"));
    const auto volume = read_any_volume(folder_ / "seg.dcm", {});
    ASSERT_TRUE(volume.ok()) << type << ": " << volume.status();
    EXPECT_THAT(volume->label_names, ElementsAre(Pair(1, "Mandible"), Pair(2, "Segment 2 (Adipose tissue)")));
    EXPECT_EQ(volume->frame, "LPS");
    expect_halves(*volume);
  }
}

TEST_F(SegmentationTest, PackedFramesAndPlanesWithoutASpacingAreRead) {
  TestSegmentation segmentation;
  segmentation.type = "FRACTIONAL";
  segmentation.syntax = EXS_RLELossless;
  segmentation.between = "";
  segmentation.write(folder_ / "seg.dcm");
  const auto volume = read_segmentation(folder_ / "seg.dcm");
  ASSERT_TRUE(volume.ok()) << volume.status();
  expect_halves(*volume);
  segmentation.type = "BINARY";
  segmentation.syntax = EXS_DeflatedLittleEndianExplicit;
  segmentation.write(folder_ / "deflated.dcm");
  const auto deflated = read_segmentation(folder_ / "deflated.dcm");
  ASSERT_TRUE(deflated.ok()) << deflated.status();
  expect_halves(*deflated);
}

TEST_F(SegmentationTest, OneAmongImagesIsReadByItsSeries) {
  TestSeries series;
  series.write(folder_ / "study");
  TestSegmentation().write(folder_ / "study" / "SEG");
  for (const char* name : {"7", "1.2.3"}) {
    const auto volume = read_any_volume(folder_ / "study", {name, false});
    ASSERT_TRUE(volume.ok()) << volume.status();
    EXPECT_EQ(volume->label_names.size(), 2u);
  }
  const auto images = read_any_volume(folder_ / "study", {});
  ASSERT_TRUE(images.ok()) << images.status();
  EXPECT_TRUE(images->label_names.empty());
  EXPECT_FALSE(is_segmentation(folder_ / "study" / "IM0000"));
}

TEST_F(SegmentationTest, SegmentsThatOverlapAreSaid) {
  TestSegmentation segmentation;
  segmentation.edit = [](DcmDataset* data_set) {
    // Each frame of segment 2 is one of segment 1 as well.
    DcmItem* groups = nullptr;
    for (int k = 0; data_set->findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, groups, k).good(); ++k) {
      DcmItem* plane = nullptr;
      groups->findAndGetSequenceItem(DCM_PlanePositionSequence, plane, 0);
      TestSeries::put_text(plane, DCM_ImagePositionPatient, absl::StrFormat("%d\\6\\%g", 5, 7.0 + 1.5 * (k % 3)));
    }
  };
  segmentation.write(folder_ / "seg.dcm");
  const auto volume = read_segmentation(folder_ / "seg.dcm");
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_TRUE(volume->remarks.empty()) << "the halves do not share voxels";
  segmentation.edit = [](DcmDataset* data_set) {
    std::vector<Uint8> all(2 * ((40 * 36 * 60 + 15) / 16), 0xFF);
    data_set->putAndInsertUint8Array(DCM_PixelData, all.data(), all.size());
  };
  segmentation.write(folder_ / "full.dcm");
  const auto full = read_segmentation(folder_ / "full.dcm");
  ASSERT_TRUE(full.ok()) << full.status();
  EXPECT_THAT(full->remarks.at(0), HasSubstr("times two segments have the same voxel"));
}

TEST_F(SegmentationTest, WhatIsWrongIsSaid) {
  const auto with = [this](const std::function<void(DcmDataset*)>& edit) {
    TestSegmentation segmentation;
    segmentation.edit = edit;
    return refusal(segmentation);
  };
  EXPECT_THAT(with([](DcmDataset* data) { data->findAndDeleteElement(DCM_SegmentSequence); }),
              HasSubstr("no SegmentSequence"));
  EXPECT_THAT(with([](DcmDataset* data) { data->findAndDeleteElement(DCM_PixelData); }), HasSubstr("has no pixels"));
  EXPECT_THAT(with([](DcmDataset* data) { data->putAndInsertUint16(DCM_BitsAllocated, 4); }),
              HasSubstr("\"BINARY\" of 4 bits"));
  EXPECT_THAT(with([](DcmDataset* data) { TestSeries::put_text(data, DCM_NumberOfFrames, "2000"); }),
              HasSubstr("asks for 360000 bytes of pixels"));
  EXPECT_THAT(with([](DcmDataset* data) { data->putAndInsertUint16(DCM_Rows, 1); }), HasSubstr("40 x 1 pixels"));
  EXPECT_THAT(with([](DcmDataset* data) {
                DcmItem *groups = nullptr, *segment = nullptr;
                data->findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, groups, 4);
                groups->findAndGetSequenceItem(DCM_SegmentIdentificationSequence, segment, 0);
                segment->putAndInsertUint16(DCM_ReferencedSegmentNumber, 9);
              }),
              HasSubstr("which of its segments frame 5 shows"));
  EXPECT_THAT(with([](DcmDataset* data) {
                DcmItem *groups = nullptr, *plane = nullptr;
                data->findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, groups, 4);
                groups->findAndGetSequenceItem(DCM_PlanePositionSequence, plane, 0);
                TestSeries::put_text(plane, DCM_ImagePositionPatient, "5\\6\\20.8");
              }),
              HasSubstr("not spaced evenly: frame 5"));
  EXPECT_THAT(with([](DcmDataset* data) {
                DcmItem *groups = nullptr, *plane = nullptr;
                data->findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, groups, 4);
                groups->findAndGetSequenceItem(DCM_PlanePositionSequence, plane, 0);
                TestSeries::put_text(plane, DCM_ImagePositionPatient, "5\\6\\600000");
              }),
              HasSubstr("mm from each other"));
}

}  // namespace
}  // namespace lipofill::client
