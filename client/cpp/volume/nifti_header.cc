#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {
namespace {

constexpr size_t kHeaderBytes = 348;

/// Numbers at the offsets of the NIfTI-1 header, in either byte order.
class HeaderBytes {
 public:
  explicit HeaderBytes(const std::array<char, kHeaderBytes>& bytes) : bytes_(bytes) {
    swapped_ = read<int32_t>(0) != 348;
  }

  bool is_nifti1() const { return read<int32_t>(0) == 348 && (text(344, 3) == "n+1" || text(344, 3) == "ni1"); }
  bool is_nifti2() const { return read<int32_t>(0) == 540; }
  std::string text(size_t offset, size_t size) const { return std::string(bytes_.data() + offset, size); }

  template <typename T>
  T read(size_t offset) const {
    std::array<char, sizeof(T)> raw;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), sizeof(T), raw.begin());
    if (swapped_) std::reverse(raw.begin(), raw.end());
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }

 private:
  const std::array<char, kHeaderBytes>& bytes_;
  bool swapped_ = false;
};

uint64_t bytes_of_datatype(int16_t datatype) {
  switch (datatype) {
    case 2:
    case 256:
      return 1;  // (un)signed char
    case 4:
    case 512:
      return 2;  // (un)signed short
    case 8:
    case 768:
    case 16:
      return 4;  // (un)signed int, float
    case 64:
      return 8;  // double
    default:
      return 0;
  }
}

absl::StatusOr<VolumeHeader> interpret(const std::filesystem::path& file, const HeaderBytes& bytes) {
  if (bytes.is_nifti2()) return bad_volume(file, "is NIfTI-2; only NIfTI-1 is read");
  if (!bytes.is_nifti1()) return bad_volume(file, "is not NIfTI-1: its header has another length or magic");
  if (bytes.text(344, 3) == "ni1")
    return bad_volume(file, "has its voxels in a file of their own (.hdr, .img); only .nii and .nii.gz are read");
  const int16_t dimensions = bytes.read<int16_t>(40);
  for (int i = 4; i <= std::min<int>(dimensions, 7); ++i) {
    if (bytes.read<int16_t>(static_cast<size_t>(40 + 2 * i)) > 1)
      return bad_volume(file, "has more than three dimensions");
  }
  if (dimensions < 3 || dimensions > 7) return bad_volume(file, absl::StrCat("has ", dimensions, " dimensions, not 3"));
  const auto sizes = parse_sizes(
      file, "dim", absl::StrCat(bytes.read<int16_t>(42), " ", bytes.read<int16_t>(44), " ", bytes.read<int16_t>(46)));
  if (!sizes.ok()) return sizes.status();
  VolumeHeader header;
  header.format = VolumeFormat::kNifti;
  header.size = *sizes;
  header.bytes_per_voxel = bytes_of_datatype(bytes.read<int16_t>(70));
  if (header.bytes_per_voxel == 0)
    return bad_volume(file, absl::StrCat("has datatype ", bytes.read<int16_t>(70), ", which is not a scalar type"));
  const float offset = bytes.read<float>(108);
  if (!(offset >= 348.0F && offset <= 1e7F))
    return bad_volume(file, absl::StrCat("has vox_offset ", offset, ", not in [348, 1e7]"));
  header.data_offset = static_cast<uint64_t>(offset);
  header.data_file = file;
  const bool oriented = bytes.read<int16_t>(252) > 0 || bytes.read<int16_t>(254) > 0;
  header.frame = oriented ? "LPS" : "the file's own";
  return header;
}

}  // namespace

absl::StatusOr<VolumeHeader> parse_nifti_header(const std::filesystem::path& file) {
  // gzread passes a file that is not compressed through as it is.
  const std::unique_ptr<gzFile_s, decltype(&gzclose)> stream(gzopen(file.c_str(), "rb"), &gzclose);
  std::array<char, kHeaderBytes> bytes{};
  if (!stream || gzread(stream.get(), bytes.data(), kHeaderBytes) != static_cast<int>(kHeaderBytes)) {
    return bad_volume(file, "is not NIfTI-1: it is shorter than a header");
  }
  auto header = interpret(file, HeaderBytes(bytes));
  if (!header.ok()) return header;
  header->compressed = gzdirect(stream.get()) == 0;
  // The compressed stream begins with the header: counted from there.
  return header;
}

}  // namespace lipofill::client
