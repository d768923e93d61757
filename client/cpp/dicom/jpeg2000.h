#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

/// The pixels of one JPEG 2000 image, by OpenJPEG. INVALID_ARGUMENT, without the file's name, for
/// what is damaged, or has another size or more than one component; the size is compared before
/// memory is taken. Checked by tests/unit/client/dicom_pixels_test.cc and
/// tests/fuzz/dicom_fuzzer.cc.
absl::StatusOr<std::vector<int32_t>> decode_jpeg2000(const std::vector<uint8_t>& bytes, uint32_t columns,
                                                     uint32_t rows);

}  // namespace lipofill::client
