#include "client/cpp/volume/volume_header.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/inflated_file.h"

namespace lipofill::client {
namespace {

/// Bytes that a compressed stream unpacks to, counted up to `enough`.
uint64_t count_inflated_bytes(const std::filesystem::path& file, uint64_t offset, uint64_t enough) {
  uint64_t count = 0;
  inflate_file(file, offset, [&](const unsigned char*, size_t bytes) { return (count += bytes) < enough; });
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
