#include "client/cpp/dicom/dicom_pixels.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcfcache.h>
#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dctk.h>

#include <array>
#include <cstring>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/dicom/dicom_library.h"
#include "client/cpp/dicom/frame_fields.h"
#include "client/cpp/dicom/jpeg2000.h"

namespace lipofill::client {
namespace {

bool is_jpeg2000(E_TransferSyntax syntax) {
  return syntax == EXS_JPEG2000LosslessOnly || syntax == EXS_JPEG2000;
}

/// The value between the high bit and the lowest stored one, with its sign.
int32_t value_of(uint32_t raw, const PixelFormat& format) {
  const int shift = format.high_bit + 1 - format.bits_stored;
  const uint32_t mask = format.bits_stored == 32 ? ~0U : (1U << format.bits_stored) - 1U;
  const uint32_t value = (raw >> shift) & mask;
  const uint32_t sign = 1U << (format.bits_stored - 1);
  return static_cast<int32_t>(format.is_signed && (value & sign) != 0 ? value | ~mask : value);
}

template <typename T>
void take_values(const std::vector<uint16_t>& buffer, const PixelFormat& format, std::vector<int32_t>* pixels) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(buffer.data());
  for (int32_t& pixel : *pixels) {
    T raw;
    std::memcpy(&raw, bytes, sizeof raw);
    bytes += sizeof raw;
    pixel = value_of(raw, format);
  }
}

/// A padding value is one of the stored pixels, written with or without its sign.
bool take_padding(DcmItem* data_set, const DcmTagKey& tag, const PixelFormat& format, int32_t* value) {
  int64_t number = 0;
  if (!absl::SimpleAtoi(text_of(data_set, tag), &number)) return false;
  PixelFormat low = format;
  low.high_bit = format.bits_stored - 1;
  *value = value_of(static_cast<uint32_t>(number), low);
  return true;
}

PixelFormat format_in(DcmItem* data_set) {
  PixelFormat format;
  format.bits_allocated = static_cast<int>(whole_number_of(data_set, DCM_BitsAllocated, 16));
  format.bits_stored = static_cast<int>(whole_number_of(data_set, DCM_BitsStored, format.bits_allocated));
  format.high_bit = static_cast<int>(whole_number_of(data_set, DCM_HighBit, format.bits_stored - 1));
  format.is_signed = whole_number_of(data_set, DCM_PixelRepresentation, 0) == 1;
  format.has_padding = take_padding(data_set, DCM_PixelPaddingValue, format, &format.padding_least);
  format.padding_most = format.padding_least;
  if (format.has_padding && take_padding(data_set, DCM_PixelPaddingRangeLimit, format, &format.padding_most) &&
      format.padding_most < format.padding_least)
    std::swap(format.padding_least, format.padding_most);
  return format;
}

}  // namespace

struct DicomPixels::OpenFile {
  std::filesystem::path name;
  DcmFileFormat format;
  E_TransferSyntax syntax = EXS_Unknown;
  DcmPixelData* pixels = nullptr;
  DcmFileCache cache;
  uint32_t next_frame = 0;   ///< the one behind the frame that was read last
  Uint32 next_fragment = 0;  ///< where its pixels begin
};

DicomPixels::DicomPixels() = default;
DicomPixels::~DicomPixels() = default;

absl::Status DicomPixels::open(const std::filesystem::path& name) {
  if (file_ && file_->name == name) return absl::OkStatus();
  prepare_dicom_library();
  file_ = std::make_unique<OpenFile>();
  file_->name = name;
  DcmElement* element = nullptr;
  if (file_->format.loadFile(name.c_str()).bad() ||
      file_->format.getDataset()->findAndGetElement(DCM_PixelData, element).bad()) {
    file_ = nullptr;
    return absl::InvalidArgumentError("cannot be read to its end");
  }
  file_->pixels = dynamic_cast<DcmPixelData*>(element);
  file_->syntax = file_->format.getDataset()->getOriginalXfer();
  if (file_->pixels != nullptr) return absl::OkStatus();
  file_ = nullptr;
  return absl::InvalidArgumentError("has pixels that are no pixel data");
}

absl::StatusOr<PixelFormat> DicomPixels::format_of(const DicomFrame& frame) {
  if (auto status = open(frame.file); !status.ok()) return status;
  return format_in(file_->format.getDataset());
}

absl::Status DicomPixels::read(const DicomFrame& frame, std::vector<int32_t>* pixels) {
  if (auto status = open(frame.file); !status.ok()) return status;
  pixels->resize(size_t{frame.columns} * frame.rows);
  if (is_jpeg2000(file_->syntax)) return read_jpeg2000(frame, pixels);
  if (file_->syntax == EXS_RLELossless) {
    if (auto status = check_rle(frame); !status.ok()) return status;
  }
  return read_stored(frame, pixels);
}

absl::Status DicomPixels::read_stored(const DicomFrame& frame, std::vector<int32_t>* pixels) {
  DcmDataset* const data_set = file_->format.getDataset();
  const PixelFormat format = format_in(data_set);
  const size_t bytes = pixels->size() * static_cast<size_t>(format.bits_allocated / 8);
  // DCMTK fills whole words.
  std::vector<uint16_t> buffer((bytes + 1) / 2);
  // Fragment 0 has DCMTK look for the frame, which it can only where each has one fragment.
  if (frame.number != file_->next_frame) file_->next_fragment = 0;
  file_->next_frame = frame.number + 1;
  OFString colours;
  const OFCondition result =
      file_->pixels->getUncompressedFrame(data_set, frame.number, file_->next_fragment, buffer.data(),
                                          static_cast<Uint32>(2 * buffer.size()), colours, &file_->cache);
  if (result.bad()) {
    const DcmXfer syntax(file_->syntax);
    return absl::InvalidArgumentError(
        absl::StrCat("has pixels that cannot be unpacked (", result.text(), "; transfer syntax ", syntax.getXferName(),
                     "): if its other images are the same, export it without compression"));
  }
  if (format.bits_allocated == 8) take_values<uint8_t>(buffer, format, pixels);
  if (format.bits_allocated == 16) take_values<uint16_t>(buffer, format, pixels);
  if (format.bits_allocated == 32) take_values<uint32_t>(buffer, format, pixels);
  return absl::OkStatus();
}

/// The packed bytes of one image. The first item of a sequence is a table of offsets; then comes
/// one for each frame, but an image alone may come in pieces.
absl::StatusOr<std::vector<uint8_t>> DicomPixels::packed_image(const DicomFrame& frame) {
  DcmPixelSequence* sequence = nullptr;
  E_TransferSyntax syntax = file_->syntax;
  const DcmRepresentationParameter* parameter = nullptr;
  file_->pixels->getOriginalRepresentationKey(syntax, parameter);
  if (file_->pixels->getEncapsulatedRepresentation(syntax, parameter, sequence).bad() || sequence == nullptr)
    return absl::InvalidArgumentError("has packed pixels that are damaged");
  const int64_t frames = whole_number_of(file_->format.getDataset(), DCM_NumberOfFrames, 1);
  const auto items = static_cast<int64_t>(sequence->card());
  if (frames > 1 && items != frames + 1)
    return absl::InvalidArgumentError(absl::StrCat("has ", frames, " packed images in ", items - 1, " pieces"));
  std::vector<uint8_t> packed;
  for (int64_t item = 1 + (frames > 1 ? frame.number : 0); item < (frames > 1 ? frame.number + 2 : items); ++item) {
    DcmPixelItem* piece = nullptr;
    Uint8* bytes = nullptr;
    if (sequence->getItem(piece, static_cast<unsigned long>(item)).bad() || piece->getUint8Array(bytes).bad() ||
        bytes == nullptr)
      return absl::InvalidArgumentError("has packed pixels that are cut short");
    packed.insert(packed.end(), bytes, bytes + piece->getLength());
  }
  return packed;
}

absl::Status DicomPixels::read_jpeg2000(const DicomFrame& frame, std::vector<int32_t>* pixels) {
  const auto packed = packed_image(frame);
  if (!packed.ok()) return packed.status();
  auto decoded = decode_jpeg2000(*packed, frame.columns, frame.rows);
  if (!decoded.ok()) return decoded.status();
  *pixels = *std::move(decoded);
  return absl::OkStatus();
}

absl::Status DicomPixels::check_rle(const DicomFrame& frame) {
  const auto packed = packed_image(frame);
  if (!packed.ok()) return packed.status();
  std::array<uint32_t, 16> header{};
  const absl::Status damaged = absl::InvalidArgumentError("has RLE pixels that are damaged or cut short");
  if (packed->size() < sizeof header) return damaged;
  std::memcpy(header.data(), packed->data(), sizeof header);
  const uint32_t segments = header[0];
  if (segments < 1 || segments >= header.size() || header[1] != sizeof header) return damaged;
  for (uint32_t k = 2; k <= segments; ++k) {
    if (header[k] < header[k - 1]) return damaged;
  }
  return header[segments] <= packed->size() ? absl::OkStatus() : damaged;
}

}  // namespace lipofill::client
