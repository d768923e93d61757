#include "client/cpp/volume/volume_header.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

bool ends_with_any(const std::string& name, std::initializer_list<const char*> endings) {
  for (const char* ending : endings) {
    if (name.ends_with(ending)) return true;
  }
  return false;
}

bool is_metaimage(const std::string& name) {
  return ends_with_any(name, {".mha", ".mhd"});
}

bool is_nrrd(const std::string& name) {
  return ends_with_any(name, {".nrrd", ".nhdr"});
}

bool is_nifti(const std::string& name) {
  return ends_with_any(name, {".nii", ".nii.gz", ".nii.bz2", ".hdr", ".hdr.gz"});
}

std::string lower_name(const std::filesystem::path& file) {
  return absl::AsciiStrToLower(file.filename().string());
}

/// Each of the files must hold its share of the voxels.
absl::Status check_against_files(const std::filesystem::path& file, const VolumeHeader& header) {
  if (header.voxel_bytes() > kMaxVolumeBytes) {
    return bad_volume(file, absl::StrCat("has ", header.voxel_bytes(), " bytes of voxels, more than the ",
                                         kMaxVolumeBytes, " allowed"));
  }
  const uint64_t share = header.voxel_bytes() / header.voxels.files.size();
  if (share * header.voxels.files.size() != header.voxel_bytes() || share % header.bytes_per_voxel != 0) {
    return bad_volume(file, absl::StrCat("has ", header.voxel_count(), " voxels, which ", header.voxels.files.size(),
                                         " files cannot share evenly"));
  }
  for (const std::filesystem::path& data : header.voxels.files) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(data, error))
      return bad_volume(file, absl::StrCat("names a data file that cannot be read: ", data.string()));
    const auto found = count_voxel_bytes(header.voxels, data, share);
    if (!found.ok()) return bad_volume(file, found.status().message());
    if (*found >= share) continue;
    return bad_volume(
        file, absl::StrCat("is cut short: its header asks for ", share, " bytes of voxels",
                           data == file ? "" : absl::StrCat(" in ", data.string()), ", ", *found, " are there"));
  }
  return absl::OkStatus();
}

}  // namespace

bool is_volume_name(const std::filesystem::path& file) {
  const std::string name = lower_name(file);
  return is_metaimage(name) || is_nrrd(name) || is_nifti(name);
}

absl::StatusOr<VolumeHeader> read_volume_header(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return bad_volume(file, "does not exist or is not a file");
  const std::string name = lower_name(file);
  absl::StatusOr<VolumeHeader> header = bad_volume(file, "is not one of .mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz, .hdr");
  if (is_metaimage(name)) header = parse_metaimage_header(file);
  if (is_nrrd(name)) header = parse_nrrd_header(file);
  if (is_nifti(name)) header = parse_nifti_header(file);
  if (!header.ok()) return header;
  header->voxels.vtk_type = header->vtk_type;
  if (auto status = check_against_files(file, *header); !status.ok()) return status;
  return header;
}

}  // namespace lipofill::client
