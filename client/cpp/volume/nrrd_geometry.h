#pragma once

#include <filesystem>
#include <vector>

#include "absl/status/status.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/volume_header.h"

namespace lipofill::client {

/// Sets the sizes and axes of a NRRD: p = origin + sum_a index_a direction_a, turned to LPS and to
/// millimetres. Axes without a direction ("none", as a list of components has) and axes beyond the
/// third may have one sample. The fields are those of "Definition of NRRD File Format"
/// (teem.sourceforge.net/nrrd/format.html, sections 5 and 6). Checked by
/// tests/unit/client/volume_kinds_test.cc.
absl::Status set_nrrd_geometry(const std::filesystem::path& file, const HeaderText& text, VolumeHeader* header);

}  // namespace lipofill::client
