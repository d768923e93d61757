// Pixels in every transfer syntax that is read, and damaged ones.

#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <gmock/gmock.h>
#include <openjpeg.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "client/cpp/dicom/jpeg2000.h"
#include "dicom_fixture.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

OPJ_SIZE_T append(void* from, OPJ_SIZE_T count, void* data) {
  const auto* bytes = static_cast<const uint8_t*>(from);
  static_cast<std::vector<uint8_t>*>(data)->insert(static_cast<std::vector<uint8_t>*>(data)->end(), bytes,
                                                   bytes + count);
  return count;
}

/// A JPEG 2000 code stream without loss.
std::vector<uint8_t> encode_jpeg2000(const uint16_t* pixels, uint32_t columns, uint32_t rows) {
  opj_image_cmptparm_t component{};
  component.dx = component.dy = 1;
  component.w = columns;
  component.h = rows;
  component.prec = 12;
  opj_image_t* image = opj_image_create(1, &component, OPJ_CLRSPC_GRAY);
  image->x1 = columns;
  image->y1 = rows;
  std::copy_n(pixels, size_t{columns} * rows, image->comps[0].data);
  opj_cparameters_t parameters;
  opj_set_default_encoder_parameters(&parameters);
  parameters.tcp_numlayers = 1;
  parameters.cp_disto_alloc = 1;
  parameters.numresolution = 3;
  std::vector<uint8_t> bytes;
  opj_stream_t* stream = opj_stream_default_create(OPJ_FALSE);
  opj_stream_set_user_data(stream, &bytes, nullptr);
  opj_stream_set_write_function(stream, append);
  opj_codec_t* codec = opj_create_compress(OPJ_CODEC_J2K);
  EXPECT_TRUE(opj_setup_encoder(codec, &parameters, image) && opj_start_compress(codec, image, stream) &&
              opj_encode(codec, stream) && opj_end_compress(codec, stream));
  opj_destroy_codec(codec);
  opj_stream_destroy(stream);
  opj_image_destroy(image);
  return bytes;
}

/// Puts encoded frames in place of a data set's pixels.
void put_encoded(DcmDataset* data_set, E_TransferSyntax syntax, const std::vector<std::vector<uint8_t>>& frames) {
  auto* sequence = new DcmPixelSequence(DCM_PixelSequenceTag);
  sequence->insert(new DcmPixelItem(DCM_PixelItemTag));
  for (std::vector<uint8_t> frame : frames) {
    if (frame.size() % 2 == 1) frame.push_back(0);
    auto* item = new DcmPixelItem(DCM_PixelItemTag);
    item->putUint8Array(frame.data(), frame.size());
    sequence->insert(item);
  }
  auto* pixels = new DcmPixelData(DCM_PixelData);
  pixels->putOriginalRepresentation(syntax, nullptr, sequence);
  data_set->insert(pixels, true);
}

class DicomPixelsTest : public DicomTest {
 protected:
  TestSeries series_;
  std::vector<uint8_t> encoded_slice(int k) const {
    const auto pixels = series_.stored_pixels();
    return encode_jpeg2000(pixels.data() + size_t{40} * 36 * static_cast<size_t>(k), 40, 36);
  }
};

TEST_F(DicomPixelsTest, EveryTransferSyntaxWithoutLoss) {
  for (const E_TransferSyntax syntax :
       {EXS_LittleEndianImplicit, EXS_BigEndianExplicit, EXS_DeflatedLittleEndianExplicit, EXS_RLELossless,
        EXS_JPEGProcess14, EXS_JPEGProcess14SV1, EXS_JPEGLSLossless}) {
    series_.syntax = syntax;
    const std::string name = absl::StrFormat("syntax%d", static_cast<int>(syntax));
    series_.write(folder_ / name);
    SCOPED_TRACE(DcmXfer(syntax).getXferName());
    expect_ball_in(name);
    series_.write_frames(folder_ / (name + ".dcm"));
    expect_ball_in(name + ".dcm");
  }
}

TEST_F(DicomPixelsTest, Jpeg2000) {
  series_.syntax = EXS_JPEG2000LosslessOnly;
  series_.edit = [this](DcmDataset* data_set, int k) { put_encoded(data_set, series_.syntax, {encoded_slice(k)}); };
  series_.write(folder_ / "ct");
  expect_ball_in("ct");
  series_.edit = [this](DcmDataset* data_set, int) {
    std::vector<std::vector<uint8_t>> frames;
    for (int k = 32; k-- > 0;) frames.push_back(encoded_slice(k));
    put_encoded(data_set, series_.syntax, frames);
  };
  series_.write_frames(folder_ / "head.dcm");
  expect_ball_in("head.dcm");
}

TEST_F(DicomPixelsTest, RefusesDamagedJpeg2000) {
  const auto whole = encoded_slice(16);
  EXPECT_TRUE(decode_jpeg2000(whole, 40, 36).ok());
  EXPECT_THAT(std::string(decode_jpeg2000(whole, 41, 36).status().message()), HasSubstr("another size"));
  EXPECT_FALSE(decode_jpeg2000({}, 40, 36).ok());
  EXPECT_FALSE(decode_jpeg2000({whole.begin(), whole.begin() + 60}, 40, 36).ok());
  series_.syntax = EXS_JPEG2000LosslessOnly;
  series_.edit = [&](DcmDataset* data_set, int k) {
    put_encoded(data_set, series_.syntax, {k == 5 ? std::vector<uint8_t>(80, 7) : encoded_slice(k)});
  };
  series_.write(folder_ / "ct");
  EXPECT_THAT(dicom_refusal_of("ct"), HasSubstr("has JPEG 2000 pixels that are damaged"));
}

TEST_F(DicomPixelsTest, SignedPixelsAndOtherWidths) {
  series_.edit = [this](DcmDataset* data_set, int k) {
    const auto voxels = series_.ball.voxels();
    std::vector<uint16_t> pixels;
    for (size_t i = 0; i < 40 * 36; ++i)
      pixels.push_back(static_cast<uint16_t>(voxels[40 * 36 * static_cast<size_t>(k) + i]));
    data_set->putAndInsertUint16Array(DCM_PixelData, pixels.data(), pixels.size());
    data_set->putAndInsertUint16(DCM_PixelRepresentation, 1);
    data_set->putAndInsertUint16(DCM_BitsStored, 16);
    data_set->putAndInsertUint16(DCM_HighBit, 15);
    TestSeries::put_text(data_set, DCM_RescaleIntercept, "0");
  };
  series_.write(folder_ / "signed");
  expect_ball_in("signed");
  // Bytes of 4 HU, which put the surface up to 2 HU, 0.008 mm, elsewhere.
  series_.edit = [this](DcmDataset* data_set, int k) {
    const auto voxels = series_.ball.voxels();
    std::vector<uint8_t> pixels;
    for (size_t i = 0; i < 40 * 36; ++i)
      pixels.push_back(static_cast<uint8_t>((voxels[40 * 36 * static_cast<size_t>(k) + i] + 1000) / 4));
    data_set->putAndInsertUint8Array(DCM_PixelData, pixels.data(), pixels.size());
    data_set->putAndInsertUint16(DCM_BitsAllocated, 8);
    data_set->putAndInsertUint16(DCM_BitsStored, 8);
    data_set->putAndInsertUint16(DCM_HighBit, 7);
    TestSeries::put_text(data_set, DCM_RescaleSlope, "4");
    TestSeries::put_text(data_set, DCM_RescaleIntercept, "-1000");
  };
  series_.write(folder_ / "bytes");
  const auto skin = extract("bytes");
  ASSERT_TRUE(skin.ok()) << skin.status();
  EXPECT_NEAR(skin->bounds_mm[0], 25 - 14, 0.05);
  EXPECT_NEAR(skin->bounds_mm[5], 31 + 14, 0.05);
}

TEST_F(DicomPixelsTest, AHeaderThatAsksForMoreThanThereIs) {
  series_.edit = [](DcmDataset* data_set, int) { TestSeries::put_text(data_set, DCM_NumberOfFrames, "9000"); };
  series_.write_frames(folder_ / "head.dcm");
  EXPECT_THAT(dicom_refusal_of("head.dcm"), HasSubstr("its header asks for 25920000 bytes of pixels, 92160 are there"));
}

}  // namespace
}  // namespace lipofill::client
