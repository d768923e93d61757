#include "client/cpp/volume/volume_header.h"

#include <zlib.h>

#include <fstream>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

/// Bytes that a gzip or zlib stream from an offset of a file unpacks to, counted up to `enough`, in constant memory.
uint64_t count_inflated_bytes(const std::filesystem::path& file, uint64_t offset, uint64_t enough) {
  std::ifstream input(file, std::ios::binary);
  input.seekg(static_cast<std::streamoff>(offset));
  z_stream stream{};
  constexpr int kDetectFormat = 15 + 32;
  if (!input || inflateInit2(&stream, kDetectFormat) != Z_OK) return 0;
  std::vector<unsigned char> packed(1 << 16), unpacked(1 << 18);
  uint64_t count = 0;
  int result = Z_OK;
  while (result == Z_OK && count < enough) {
    if (stream.avail_in == 0) {
      input.read(reinterpret_cast<char*>(packed.data()), static_cast<std::streamsize>(packed.size()));
      stream.next_in = packed.data();
      stream.avail_in = static_cast<uInt>(input.gcount());
      if (stream.avail_in == 0) break;
    }
    stream.next_out = unpacked.data();
    stream.avail_out = static_cast<uInt>(unpacked.size());
    result = inflate(&stream, Z_NO_FLUSH);
    count += unpacked.size() - stream.avail_out;
  }
  inflateEnd(&stream);
  return count;
}

absl::Status check_against_file(const std::filesystem::path& file, const VolumeHeader& header) {
  if (header.voxel_bytes() > kMaxVolumeBytes) {
    return bad_volume(file, absl::StrCat("has ", header.voxel_bytes(), " bytes of voxels, more than the ",
                                         kMaxVolumeBytes, " allowed"));
  }
  std::error_code error;
  const uint64_t file_bytes = std::filesystem::file_size(header.data_file, error);
  if (error)
    return bad_volume(file, absl::StrCat("names a data file that cannot be read: ", header.data_file.string()));
  // A compressed NIfTI is compressed from its first byte on.
  const bool header_inside = header.compressed && header.format == VolumeFormat::kNifti;
  const uint64_t expected = header.voxel_bytes() + (header_inside ? header.data_offset : 0);
  const uint64_t begin = header_inside ? 0 : header.data_offset;
  const uint64_t found = header.compressed ? count_inflated_bytes(header.data_file, begin, expected)
                                           : (file_bytes > begin ? file_bytes - begin : 0);
  if (found >= expected) return absl::OkStatus();
  return bad_volume(
      file, absl::StrCat("is cut short: its header asks for ", expected, " bytes of voxels, ", found, " are there"));
}

}  // namespace

absl::StatusOr<VolumeHeader> read_volume_header(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return bad_volume(file, "does not exist or is not a file");
  const std::string name = absl::AsciiStrToLower(file.filename().string());
  absl::StatusOr<VolumeHeader> header = bad_volume(file, "is not one of .mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz");
  if (name.ends_with(".mha") || name.ends_with(".mhd")) header = parse_metaimage_header(file);
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) header = parse_nrrd_header(file);
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) header = parse_nifti_header(file);
  if (!header.ok()) return header;
  if (auto status = check_against_file(file, *header); !status.ok()) return status;
  return header;
}

}  // namespace lipofill::client
