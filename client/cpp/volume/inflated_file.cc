#include "client/cpp/volume/inflated_file.h"

#include <zlib.h>

#include <fstream>
#include <vector>

namespace lipofill::client {

void inflate_file(const std::filesystem::path& file, uint64_t offset,
                  const std::function<bool(const unsigned char*, size_t)>& take) {
  std::ifstream input(file, std::ios::binary);
  input.seekg(static_cast<std::streamoff>(offset));
  z_stream stream{};
  constexpr int kDetectFormat = 15 + 32;
  if (!input || inflateInit2(&stream, kDetectFormat) != Z_OK) return;
  std::vector<unsigned char> packed(1 << 16), unpacked(1 << 18);
  bool wants_more = true;
  for (int result = Z_OK; result == Z_OK && wants_more;) {
    if (stream.avail_in == 0) {
      input.read(reinterpret_cast<char*>(packed.data()), static_cast<std::streamsize>(packed.size()));
      stream.next_in = packed.data();
      stream.avail_in = static_cast<uInt>(input.gcount());
      if (stream.avail_in == 0) break;
    }
    stream.next_out = unpacked.data();
    stream.avail_out = static_cast<uInt>(unpacked.size());
    result = inflate(&stream, Z_NO_FLUSH);
    wants_more = take(unpacked.data(), unpacked.size() - stream.avail_out);
  }
  inflateEnd(&stream);
}

}  // namespace lipofill::client
