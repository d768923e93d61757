#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace lipofill::client {

inline constexpr size_t kNifti1HeaderBytes = 348;
inline constexpr size_t kNifti2HeaderBytes = 540;

/// The fields of a NIfTI header that say what and where its voxels are, under the names of the
/// standard (nifti.nimh.nih.gov, nifti1.h and nifti2.h).
struct NiftiFields {
  size_t header_bytes = 0;
  bool big_endian = false;
  bool single_file = false;  ///< .nii; otherwise the voxels are in an .img beside the .hdr
  std::array<int64_t, 8> dim{};
  std::array<double, 8> pixdim{};
  int64_t datatype = 0;
  double voxel_offset = 0.0;
  double slope = 0.0;
  double intercept = 0.0;
  int64_t units = 0;
  int64_t qform_code = 0;
  int64_t sform_code = 0;
  std::array<double, 3> quaternion{};  ///< b, c, d
  std::array<double, 3> qoffset{};
  std::array<double, 12> srow{};  ///< three rows of four
};

/// Reads the header of NIfTI-1 or -2, in either byte order; none for another length or magic.
/// Checked by tests/unit/client/volume_kinds_test.cc.
std::optional<NiftiFields> parse_nifti_fields(std::string_view bytes);

}  // namespace lipofill::client
