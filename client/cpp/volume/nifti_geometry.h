#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "client/cpp/volume/nifti_fields.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {

/// Sets the map from voxel centres to millimetres. NIfTI's axes are RAS, which is turned to LPS.
///
///     sform_code > 0:  p = S (i, j, k, 1)
///     qform_code > 0:  p = R(a, b, c, d) diag(1, 1, qfac) diag(pixdim) (i, j, k) + qoffset
///     neither:         p = diag(pixdim) (i, j, k), in the file's own axes
///
/// A sform that does not span space, such as all zeros, gives way to the qform, and a pixdim counts
/// without its sign, as nibabel has it; remarks say so. INVALID_ARGUMENT for numbers that are not
/// finite. Checked by tests/unit/client/volume_kinds_test.cc.
absl::Status set_nifti_geometry(const std::filesystem::path& file, const NiftiFields& fields, VolumeHeader* header);

/// Sets value = scl_slope * voxel + scl_inter; a slope of 0, or that is no number, scales nothing.
void set_nifti_scaling(const NiftiFields& fields, VolumeHeader* header);

}  // namespace lipofill::client
