#pragma once

#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace lipofill::client {

/// A ball of soft tissue (0 HU) in air (-1000 HU) on a grid, its edge linear over two voxel widths
/// so that its surface at -500 lies where it should.
struct BallVolume {
  std::array<int, 3> size{40, 36, 32};
  std::array<double, 3> spacing{1.0, 1.25, 1.5};
  std::array<double, 3> centre{20.0, 22.0, 24.0};  ///< [mm], in the grid's own axes
  double radius = 14.0;

  std::vector<int16_t> voxels() const {
    std::vector<int16_t> values;
    for (int k = 0; k < size[2]; ++k) {
      for (int j = 0; j < size[1]; ++j) {
        for (int i = 0; i < size[0]; ++i) {
          const double r =
              std::hypot(i * spacing[0] - centre[0], j * spacing[1] - centre[1], k * spacing[2] - centre[2]);
          values.push_back(
              static_cast<int16_t>(std::lround(std::min(0.0, std::max(-1000.0, -500.0 + 250.0 * (radius - r))))));
        }
      }
    }
    return values;
  }
  std::string bytes() const {
    const auto values = voxels();
    return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(int16_t));
  }
};

inline std::string gzipped(const std::string& data) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, data.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(data.data()));
  stream.avail_in = static_cast<uInt>(data.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

inline std::string metaimage(const BallVolume& ball, const std::string& matrix = "1 0 0 0 1 0 0 0 1",
                             const std::string& offset = "0 0 0") {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nTransformMatrix = " +
         matrix + "\nOffset = " + offset +
         "\nElementSpacing = 1 1.25 1.5\nDimSize = 40 36 32\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
         ball.bytes();
}

inline std::string nrrd(const BallVolume& ball, const std::string& space, const std::string& encoding) {
  const std::string header =
      "NRRD0004\n# a ball\ntype: short\ndimension: 3\nspace: " + space +
      "\nsizes: 40 36 32\nspace directions: (1,0,0) (0,1.25,0) (0,0,1.5)\nkinds: domain domain domain\n"
      "endian: little\nencoding: " +
      encoding + "\nspace origin: (5,6,7)\n\n";
  return header + (encoding == "raw" ? ball.bytes() : gzipped(ball.bytes()));
}

/// The 16-bit voxels at the end of a volume with the more significant byte first.
inline std::string big_endian(std::string bytes, const BallVolume& ball, const std::string& little,
                              const std::string& big) {
  bytes.replace(bytes.find(little), little.size(), big);
  for (size_t k = bytes.size() - ball.bytes().size(); k < bytes.size(); k += 2) std::swap(bytes[k], bytes[k + 1]);
  return bytes;
}

/// A NIfTI-1 file whose sform maps voxels to RAS: x = i - 10, y = 1.25 j + 3, z = 1.5 k.
inline std::string nifti(const BallVolume& ball) {
  std::string header(352, '\0');
  const auto put = [&header](size_t offset, auto value) { std::memcpy(header.data() + offset, &value, sizeof value); };
  put(0, int32_t{348});
  const int16_t dim[] = {3, 40, 36, 32, 1, 1, 1, 1};
  std::memcpy(header.data() + 40, dim, sizeof dim);
  put(70, int16_t{4});
  put(72, int16_t{16});
  const float pixdim[] = {1, 1, 1.25F, 1.5F, 0, 0, 0, 0};
  std::memcpy(header.data() + 76, pixdim, sizeof pixdim);
  put(108, 352.0F);
  put(112, 1.0F);
  put(254, int16_t{1});
  const float sform[] = {1, 0, 0, -10, 0, 1.25F, 0, 3, 0, 0, 1.5F, 0};
  std::memcpy(header.data() + 280, sform, sizeof sform);
  std::memcpy(header.data() + 344, "n+1", 4);
  return header + ball.bytes();
}

}  // namespace lipofill::client
