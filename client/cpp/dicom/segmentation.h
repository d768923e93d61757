#pragma once

#include <filesystem>
#include <string>

#include "absl/status/statusor.h"
#include "client/cpp/volume/volume_reader.h"

namespace lipofill::client {

/// Tells whether a file is a DICOM segmentation (modality SEG).
bool is_segmentation(const std::filesystem::path& file);

/// Tells whether it is one of the series of this number or UID.
bool is_segmentation_of(const std::filesystem::path& file, const std::string& series);

/// The segments of a DICOM segmentation as a label map, whose labels are the numbers of the
/// segments and are named by their labels and the meaning of their property type. Binary
/// segmentations, fractional ones (from half of their greatest value on) and label maps are read,
/// uncompressed or, where a pixel has 8 bits or more, packed as DicomPixels reads them. Planes of
/// which no frame says anything are empty; one empty plane is laid before the first and behind the
/// last, so that surfaces close. Of two segments in a voxel the one of the higher number counts,
/// and a remark says how often.
///
///     voxel (i, j, k) = p_first + k s + i dx row + j dy column,   s = (p_last - p_first) / K
///
/// where the spacing that the header gives, or else the least distance between planes, makes K of
/// the distance. INVALID_ARGUMENT, without names of the patient, for frames that do not lie so,
/// that name no segment, or that are cut short. Takes two bytes a voxel and one frame. Checked by
/// tests/unit/client/segmentation_test.cc and tests/fuzz/segmentation_fuzzer.cc.
absl::StatusOr<Volume> read_segmentation(const std::filesystem::path& file);

}  // namespace lipofill::client
