#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "absl/status/statusor.h"

namespace lipofill::client {

enum class VolumeFormat { kMetaImage, kNrrd, kNifti };

/// Row-major 4 x 4 affine map.
using Affine = std::array<double, 16>;

/// The header of a volume file, checked against the file before any voxel is read.
struct VolumeHeader {
  VolumeFormat format = VolumeFormat::kMetaImage;
  std::array<uint64_t, 3> size{};
  uint64_t bytes_per_voxel = 0;
  int vtk_type = 0;         ///< a voxel is VTK_SHORT and so on; NIfTI does not say
  bool big_endian = false;  ///< the same
  bool compressed = false;
  std::filesystem::path data_file;  ///< may be the header's own file
  uint64_t data_offset = 0;
  /// Voxel index (i, j, k, 1) to millimetres. Not set for NIfTI, whose reader gives it.
  Affine index_to_mm{};
  /// "LPS" (x left, y back, z up), or "the file's own" where the header names no patient axes.
  std::string frame;

  uint64_t voxel_bytes() const { return size[0] * size[1] * size[2] * bytes_per_voxel; }
};

inline constexpr uint64_t kMaxVolumeBytes = uint64_t{2} << 30;

/// Reads the header of a MetaImage (.mha, .mhd), NRRD (.nrrd, .nhdr) or NIfTI-1 (.nii, .nii.gz)
/// volume. INVALID_ARGUMENT, naming the file and what is wrong, for another format, a volume that
/// is not one scalar at each point of a 3-d grid, more than kMaxVolumeBytes of voxels, or a file
/// that holds fewer bytes than its header says (compressed ones are unpacked to be counted, in
/// constant memory). Checked by tests/unit/client/volume_test.cc.
absl::StatusOr<VolumeHeader> read_volume_header(const std::filesystem::path& file);

// One format each; sizes against the file are checked by read_volume_header.
absl::StatusOr<VolumeHeader> parse_metaimage_header(const std::filesystem::path& file);
absl::StatusOr<VolumeHeader> parse_nrrd_header(const std::filesystem::path& file);
absl::StatusOr<VolumeHeader> parse_nifti_header(const std::filesystem::path& file);

}  // namespace lipofill::client
