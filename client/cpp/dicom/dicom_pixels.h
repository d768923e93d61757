#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cpp/dicom/dicom_frame.h"

namespace lipofill::client {

/// The format says how the pixels of an image are stored.
struct PixelFormat {
  int bits_allocated = 0;
  int bits_stored = 0;
  int high_bit = 0;
  bool is_signed = false;
  bool has_padding = false;
  int32_t padding_least = 0;  ///< pixels of [padding_least, padding_most] show nothing
  int32_t padding_most = 0;
};

/// Reads the pixels of images, one file open at a time, one frame in memory. Uncompressed,
/// deflated, RLE, JPEG (8 to 16 bit, with and without loss), JPEG-LS and JPEG 2000 are read.
/// Checked by tests/unit/client/dicom_pixels_test.cc.
class DicomPixels {
 public:
  DicomPixels();
  ~DicomPixels();
  DicomPixels(const DicomPixels&) = delete;
  DicomPixels& operator=(const DicomPixels&) = delete;

  /// The format of a frame's pixels. INVALID_ARGUMENT for a file that cannot be read.
  absl::StatusOr<PixelFormat> format_of(const DicomFrame& frame);

  /// Stored pixels, row by row, with their sign and without what stands in bits beside them.
  /// INVALID_ARGUMENT, without the file's name, for pixels that are damaged or whose transfer
  /// syntax is not read.
  absl::Status read(const DicomFrame& frame, std::vector<int32_t>* pixels);

 private:
  struct OpenFile;
  absl::Status open(const std::filesystem::path& file);
  absl::Status read_stored(const DicomFrame& frame, std::vector<int32_t>* pixels);
  absl::Status read_jpeg2000(const DicomFrame& frame, std::vector<int32_t>* pixels);
  absl::StatusOr<std::vector<uint8_t>> packed_image(const DicomFrame& frame);
  /// DCMTK believes the header of an RLE image, in which offsets of segments stand (PS3.5, G.5),
  /// and reads beyond its end where they lie.
  absl::Status check_rle(const DicomFrame& frame);

  std::unique_ptr<OpenFile> file_;
};

}  // namespace lipofill::client
