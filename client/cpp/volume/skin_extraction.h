#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/volume/volume_reader.h"

namespace lipofill::client {

struct SkinExtraction {
  double isovalue = -300.0;  ///< in the volume's own values; -300 HU is the skin in a CT
  /// Of a label map: what lies in voxels of these, numbers, names or tissues as choose_labels() has
  /// them; the isovalue is not used.
  std::vector<std::string> labels = {};
  bool all_components = false;    ///< take everything, not only the largest connected piece
  int smoothing_iterations = 0;   ///< windowed sinc; 0: none
  uint64_t target_triangles = 0;  ///< decimate down to about as many; 0: not at all
};

/// Result of the extraction.
struct ExtractedSkin {
  uint64_t vertices = 0;
  uint64_t triangles = 0;
  int components = 0;  ///< before the largest was chosen
  std::array<double, 6> bounds_mm{};
  std::string frame;                 ///< "LPS" (x left, y back, z up) or "the file's own"
  std::vector<std::string> remarks;  ///< what was odd in the volume, and how it was understood
};

/// The surface where a volume takes a value, as triangles in millimetres whose normals point to the
/// lower values (out of a head in air), in the patient's LPS axes where the volume says what they
/// are. The largest connected piece of a CT head at -300 HU is the skin together with the walls of
/// the airways and sinuses that open to the outside; the model builder keeps only what is seen from
/// outside.
/// @param volume  what read_volume or read_dicom_volume gave; its voxels are released on the way
/// @param source  where the volume came from, for messages
/// @param out     .obj, .ply or .stl
/// INVALID_ARGUMENT for a volume that has no such surface, with the range of its values and a value
/// to try. Needs memory for the volume and its surface. Checked by
/// tests/unit/client/volume_test.cc: a sphere in each format, oblique axes, truncated files.
absl::StatusOr<ExtractedSkin> extract_skin(Volume volume, const std::filesystem::path& source,
                                           const std::filesystem::path& out, const SkinExtraction& options);

/// The same of a file: .mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz or .hdr.
absl::StatusOr<ExtractedSkin> extract_skin(const std::filesystem::path& volume, const std::filesystem::path& out,
                                           const SkinExtraction& options);

/// INVALID_ARGUMENT for a file name that is none of .obj, .ply and .stl.
absl::Status check_surface_name(const std::filesystem::path& out);

}  // namespace lipofill::client
