#include "client/cpp/volume/nifti_fields.h"

#include <algorithm>
#include <cstring>

namespace lipofill::client {
namespace {

/// Numbers at the offsets of a header, in either byte order.
class HeaderBytes {
 public:
  HeaderBytes(std::string_view bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}

  template <typename T>
  T read(size_t offset) const {
    std::array<char, sizeof(T)> raw;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), sizeof(T), raw.begin());
    if (big_endian_) std::reverse(raw.begin(), raw.end());
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }

  template <typename T, typename To, size_t kCount>
  void read_all(size_t offset, std::array<To, kCount>* values) const {
    for (size_t k = 0; k < kCount; ++k) (*values)[k] = static_cast<To>(read<T>(offset + k * sizeof(T)));
  }

  std::string_view text(size_t offset, size_t size) const { return bytes_.substr(offset, size); }

 private:
  std::string_view bytes_;
  bool big_endian_;
};

std::optional<NiftiFields> read_nifti1(const HeaderBytes& bytes) {
  NiftiFields fields;
  const std::string_view magic = bytes.text(344, 3);
  if (magic != "n+1" && magic != "ni1") return std::nullopt;
  fields.single_file = magic == "n+1";
  fields.header_bytes = kNifti1HeaderBytes;
  bytes.read_all<int16_t>(40, &fields.dim);
  fields.datatype = bytes.read<int16_t>(70);
  bytes.read_all<float>(76, &fields.pixdim);
  fields.voxel_offset = bytes.read<float>(108);
  fields.slope = bytes.read<float>(112);
  fields.intercept = bytes.read<float>(116);
  fields.units = bytes.read<uint8_t>(123);
  fields.qform_code = bytes.read<int16_t>(252);
  fields.sform_code = bytes.read<int16_t>(254);
  bytes.read_all<float>(256, &fields.quaternion);
  bytes.read_all<float>(268, &fields.qoffset);
  bytes.read_all<float>(280, &fields.srow);
  return fields;
}

std::optional<NiftiFields> read_nifti2(const HeaderBytes& bytes) {
  NiftiFields fields;
  const std::string_view magic = bytes.text(4, 3);
  if (magic != "n+2" && magic != "ni2") return std::nullopt;
  fields.single_file = magic == "n+2";
  fields.header_bytes = kNifti2HeaderBytes;
  fields.datatype = bytes.read<int16_t>(12);
  bytes.read_all<int64_t>(16, &fields.dim);
  bytes.read_all<double>(104, &fields.pixdim);
  fields.voxel_offset = static_cast<double>(bytes.read<int64_t>(168));
  fields.slope = bytes.read<double>(176);
  fields.intercept = bytes.read<double>(184);
  fields.qform_code = bytes.read<int32_t>(344);
  fields.sform_code = bytes.read<int32_t>(348);
  bytes.read_all<double>(352, &fields.quaternion);
  bytes.read_all<double>(376, &fields.qoffset);
  bytes.read_all<double>(400, &fields.srow);
  fields.units = bytes.read<int32_t>(500);
  return fields;
}

}  // namespace

std::optional<NiftiFields> parse_nifti_fields(std::string_view bytes) {
  for (const bool big_endian : {false, true}) {
    const HeaderBytes header(bytes, big_endian);
    std::optional<NiftiFields> fields;
    if (bytes.size() >= kNifti1HeaderBytes && header.read<int32_t>(0) == 348) fields = read_nifti1(header);
    if (bytes.size() >= kNifti2HeaderBytes && header.read<int32_t>(0) == 540) fields = read_nifti2(header);
    if (!fields) continue;
    fields->big_endian = big_endian;
    return fields;
  }
  return std::nullopt;
}

}  // namespace lipofill::client
