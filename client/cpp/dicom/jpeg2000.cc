#include "client/cpp/dicom/jpeg2000.h"

#include <openjpeg.h>

#include <algorithm>
#include <cstring>
#include <memory>

namespace lipofill::client {
namespace {

/// Bytes that OpenJPEG reads through a stream of its own.
struct Cursor {
  const std::vector<uint8_t>* bytes;
  size_t at = 0;
};

constexpr OPJ_SIZE_T kEndOfStream = static_cast<OPJ_SIZE_T>(-1);

OPJ_SIZE_T read_bytes(void* to, OPJ_SIZE_T count, void* data) {
  auto* const cursor = static_cast<Cursor*>(data);
  const size_t taken = std::min<size_t>(count, cursor->bytes->size() - cursor->at);
  if (taken == 0) return kEndOfStream;
  std::memcpy(to, cursor->bytes->data() + cursor->at, taken);
  cursor->at += taken;
  return taken;
}

OPJ_OFF_T skip_bytes(OPJ_OFF_T count, void* data) {
  auto* const cursor = static_cast<Cursor*>(data);
  if (count < 0) return -1;
  const size_t taken = std::min<size_t>(static_cast<size_t>(count), cursor->bytes->size() - cursor->at);
  cursor->at += taken;
  return static_cast<OPJ_OFF_T>(taken);
}

OPJ_BOOL seek_bytes(OPJ_OFF_T to, void* data) {
  auto* const cursor = static_cast<Cursor*>(data);
  if (to < 0 || static_cast<size_t>(to) > cursor->bytes->size()) return OPJ_FALSE;
  cursor->at = static_cast<size_t>(to);
  return OPJ_TRUE;
}

// A stream and a codec are the same type to C, so each has its own way to be released.
using Stream = std::unique_ptr<opj_stream_t, decltype(&opj_stream_destroy)>;
using Codec = std::unique_ptr<opj_codec_t, decltype(&opj_destroy_codec)>;
using Image = std::unique_ptr<opj_image_t, decltype(&opj_image_destroy)>;

Stream make_stream(Cursor* cursor) {
  Stream stream(opj_stream_default_create(OPJ_TRUE), &opj_stream_destroy);
  if (!stream) return stream;
  opj_stream_set_user_data(stream.get(), cursor, nullptr);
  opj_stream_set_user_data_length(stream.get(), cursor->bytes->size());
  opj_stream_set_read_function(stream.get(), read_bytes);
  opj_stream_set_skip_function(stream.get(), skip_bytes);
  opj_stream_set_seek_function(stream.get(), seek_bytes);
  return stream;
}

/// A code stream begins with its marker, a JP2 file with the length of its first box.
OPJ_CODEC_FORMAT format_of(const std::vector<uint8_t>& bytes) {
  return !bytes.empty() && bytes[0] == 0xFF ? OPJ_CODEC_J2K : OPJ_CODEC_JP2;
}

bool has_size(const opj_image_t& image, uint32_t columns, uint32_t rows) {
  return image.numcomps == 1 && image.comps[0].dx == 1 && image.comps[0].dy == 1 && image.x1 - image.x0 == columns &&
         image.y1 - image.y0 == rows;
}

}  // namespace

absl::StatusOr<std::vector<int32_t>> decode_jpeg2000(const std::vector<uint8_t>& bytes, uint32_t columns,
                                                     uint32_t rows) {
  Cursor cursor{&bytes};
  const Stream stream = make_stream(&cursor);
  const Codec codec(opj_create_decompress(format_of(bytes)), &opj_destroy_codec);
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  opj_image_t* header = nullptr;
  const bool has_header = stream && codec && opj_setup_decoder(codec.get(), &parameters) &&
                          opj_read_header(stream.get(), codec.get(), &header);
  const Image image(header, &opj_image_destroy);
  if (!has_header || !image) return absl::InvalidArgumentError("has JPEG 2000 pixels that are damaged");
  if (!has_size(*image, columns, rows))
    return absl::InvalidArgumentError("has JPEG 2000 pixels of another size or kind than its header says");
  if (!opj_decode(codec.get(), stream.get(), image.get()) || image->comps[0].data == nullptr ||
      image->comps[0].w != columns || image->comps[0].h != rows)
    return absl::InvalidArgumentError("has JPEG 2000 pixels that are damaged or cut short");
  const OPJ_INT32* const data = image->comps[0].data;
  return std::vector<int32_t>(data, data + size_t{columns} * rows);
}

}  // namespace lipofill::client
