#pragma once

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmdata/dctk.h>
#include <dcmtk/dcmjpeg/djencode.h>
#include <dcmtk/dcmjpls/djencode.h>

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "test_volumes.h"

namespace lipofill::client {

/// What a test changes in the data set of slice k.
using EditSlice = std::function<void(DcmDataset* data_set, int k)>;

/// A CT of the ball of test_volumes.h at (25, 28, 31) mm: pixels of 12 bits, 0 is -1024 HU.
/// The patient's name is JANE^SECRET, which nothing may show.
class TestSeries {
 public:
  BallVolume ball;
  std::string uid = "1.2.826.0.1.3680043.9.9999.1";
  int number = 2;
  std::string patient = "4711";
  std::string description = "Head 1.5 mm";
  E_TransferSyntax syntax = EXS_LittleEndianExplicit;
  EditSlice edit = [](DcmDataset*, int) {};

  static constexpr int kOffset = 1024;

  /// A file a slice, their names in another order than their places.
  void write(const std::filesystem::path& folder) const {
    std::filesystem::create_directories(folder);
    for (int k = 0; k < ball.size[2]; ++k) write_slice(k, folder / absl::StrFormat("IM%04d", (k * 7) % ball.size[2]));
  }

  void write_slice(int k, const std::filesystem::path& file) const {
    DcmFileFormat format;
    DcmDataset* const data_set = format.getDataset();
    put_common(data_set, absl::StrFormat("%s.%d", uid, k + 1));
    put_text(data_set, DCM_InstanceNumber, std::to_string(k + 1));
    put_text(data_set, DCM_ImagePositionPatient, absl::StrFormat("5\\6\\%g", 7.0 + ball.spacing[2] * k));
    put_text(data_set, DCM_ImageOrientationPatient, "1\\0\\0\\0\\1\\0");
    put_text(data_set, DCM_PixelSpacing, absl::StrFormat("%g\\%g", ball.spacing[1], ball.spacing[0]));
    put_text(data_set, DCM_RescaleSlope, "1");
    put_text(data_set, DCM_RescaleIntercept, std::to_string(-kOffset));
    const auto pixels = stored_pixels();
    const size_t size = static_cast<size_t>(ball.size[0]) * static_cast<size_t>(ball.size[1]);
    data_set->putAndInsertUint16Array(DCM_PixelData, pixels.data() + size * static_cast<size_t>(k), size);
    edit(data_set, k);
    save(&format, file);
  }

  /// One Enhanced CT file: places and rescale in functional groups, the frames from the top down.
  void write_frames(const std::filesystem::path& file) const {
    DcmFileFormat format;
    DcmDataset* const data_set = format.getDataset();
    put_common(data_set, uid + ".1");
    put_text(data_set, DCM_NumberOfFrames, std::to_string(ball.size[2]));
    auto pixels = stored_pixels();
    const size_t size = static_cast<size_t>(ball.size[0]) * static_cast<size_t>(ball.size[1]);
    std::vector<uint16_t> turned;
    for (int k = ball.size[2]; k-- > 0;) {
      const auto begin = pixels.begin() + static_cast<std::ptrdiff_t>(size) * k;
      turned.insert(turned.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
      put_group(data_set, DCM_PerFrameFunctionalGroupsSequence, ball.size[2] - 1 - k, DCM_PlanePositionSequence,
                DCM_ImagePositionPatient, absl::StrFormat("5\\6\\%g", 7.0 + ball.spacing[2] * k));
    }
    const auto put_shared = [&](const DcmTagKey& group, const DcmTagKey& tag, const std::string& text) {
      put_group(data_set, DCM_SharedFunctionalGroupsSequence, 0, group, tag, text);
    };
    put_shared(DCM_PlaneOrientationSequence, DCM_ImageOrientationPatient, "1\\0\\0\\0\\1\\0");
    put_shared(DCM_PixelMeasuresSequence, DCM_PixelSpacing,
               absl::StrFormat("%g\\%g", ball.spacing[1], ball.spacing[0]));
    put_shared(DCM_PixelValueTransformationSequence, DCM_RescaleSlope, "1");
    put_shared(DCM_PixelValueTransformationSequence, DCM_RescaleIntercept, std::to_string(-kOffset));
    data_set->putAndInsertUint16Array(DCM_PixelData, turned.data(), turned.size());
    edit(data_set, 0);
    save(&format, file);
  }

  std::vector<uint16_t> stored_pixels() const {
    std::vector<uint16_t> pixels;
    for (const int16_t voxel : ball.voxels()) pixels.push_back(static_cast<uint16_t>(voxel + kOffset));
    return pixels;
  }

  static void put_text(DcmItem* item, const DcmTagKey& tag, const std::string& text) {
    item->putAndInsertOFStringArray(tag, text.c_str());
  }

 private:
  void put_common(DcmDataset* data_set, const std::string& image_uid) const {
    put_text(data_set, DCM_SOPClassUID, UID_CTImageStorage);
    put_text(data_set, DCM_SOPInstanceUID, image_uid);
    put_text(data_set, DCM_PatientName, "JANE^SECRET");
    put_text(data_set, DCM_PatientID, patient);
    put_text(data_set, DCM_Modality, "CT");
    put_text(data_set, DCM_ImageType, "ORIGINAL\\PRIMARY\\AXIAL");
    put_text(data_set, DCM_SeriesInstanceUID, uid);
    put_text(data_set, DCM_StudyInstanceUID, uid + ".0");
    put_text(data_set, DCM_SeriesNumber, std::to_string(number));
    put_text(data_set, DCM_SeriesDescription, description);
    put_text(data_set, DCM_PhotometricInterpretation, "MONOCHROME2");
    for (const auto& [tag, value] : {std::pair{DCM_Rows, ball.size[1]},
                                     {DCM_Columns, ball.size[0]},
                                     {DCM_SamplesPerPixel, 1},
                                     {DCM_BitsAllocated, 16},
                                     {DCM_BitsStored, 12},
                                     {DCM_HighBit, 11},
                                     {DCM_PixelRepresentation, 0}})
      data_set->putAndInsertUint16(tag, static_cast<Uint16>(value));
  }

  static void put_group(DcmDataset* data_set, const DcmTagKey& sequence, int item, const DcmTagKey& group,
                        const DcmTagKey& tag, const std::string& text) {
    DcmItem* frame = nullptr;
    DcmItem* macro = nullptr;
    data_set->findOrCreateSequenceItem(sequence, frame, item);
    frame->findOrCreateSequenceItem(group, macro, 0);
    put_text(macro, tag, text);
  }

  void save(DcmFileFormat* format, const std::filesystem::path& file) const {
    DcmRLEEncoderRegistration::registerCodecs();
    DJEncoderRegistration::registerCodecs();
    DJLSEncoderRegistration::registerCodecs();
    if (format->getDataset()->chooseRepresentation(syntax, nullptr).bad() ||
        format->saveFile(file.c_str(), syntax).bad())
      throw std::runtime_error("DCMTK does not write " + file.string());
  }
};

}  // namespace lipofill::client
