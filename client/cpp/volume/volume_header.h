#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/volume/voxel_stream.h"

namespace lipofill::client {

/// Row-major 4 x 4 affine map.
using Affine = std::array<double, 16>;

/// What a label map calls its labels.
using LabelNames = std::map<int64_t, std::string>;

/// The header of a volume file, checked against the file before any voxel is kept.
struct VolumeHeader {
  std::array<uint64_t, 3> size{};
  uint64_t bytes_per_voxel = 0;
  int vtk_type = 0;  ///< a voxel is VTK_SHORT and so on
  bool big_endian = false;
  VoxelStream voxels;
  double slope = 1.0;  ///< value = slope * voxel + intercept
  double intercept = 0.0;
  /// Voxel index (i, j, k, 1) to millimetres.
  Affine index_to_mm{};
  /// "LPS" (x left, y back, z up), or "the file's own" where the header names no patient axes.
  std::string frame;
  LabelNames label_names;            ///< of a segmentation that names what its labels are
  std::vector<std::string> remarks;  ///< what was odd in the file, and how it was understood

  uint64_t voxel_count() const { return size[0] * size[1] * size[2]; }
  uint64_t voxel_bytes() const { return voxel_count() * bytes_per_voxel; }
};

inline constexpr uint64_t kMaxVolumeBytes = uint64_t{2} << 30;

/// Reads the header of a MetaImage (.mha, .mhd), NRRD (.nrrd, .nhdr) or NIfTI-1 or -2 (.nii, .hdr
/// with .img, also gzipped or with bzip2) volume. INVALID_ARGUMENT, naming the file and what is
/// wrong, for another format, a volume that is not one scalar at each point of a 3-d grid, more
/// than kMaxVolumeBytes of voxels, or a file that holds fewer voxels than its header says
/// (compressed ones are unpacked to be counted, in constant memory). Checked by
/// tests/unit/client/volume_test.cc and volume_kinds_test.cc.
absl::StatusOr<VolumeHeader> read_volume_header(const std::filesystem::path& file);

/// Tells whether read_volume_header knows the ending of a file's name.
bool is_volume_name(const std::filesystem::path& file);

// One format each; the voxels themselves are checked by read_volume_header.
absl::StatusOr<VolumeHeader> parse_metaimage_header(const std::filesystem::path& file);
absl::StatusOr<VolumeHeader> parse_nrrd_header(const std::filesystem::path& file);
absl::StatusOr<VolumeHeader> parse_nifti_header(const std::filesystem::path& file);

}  // namespace lipofill::client
