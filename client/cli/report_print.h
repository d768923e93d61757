#pragma once

#include <filesystem>

#include "absl/status/status.h"

namespace lipofill::client {

/// Prints an HTML file to a PDF whose text, headings, tables and pictures are tagged, by a Chromium
/// or Chrome on PATH, which runs no script and needs no screen (core/doc/decisions/044-report.md).
/// FAILED_PRECONDITION, saying what to install, without one; INTERNAL, with what it said, where it
/// does not print. Checked by tests/integration/cli/report_test.cc.
absl::Status print_html(const std::filesystem::path& html, const std::filesystem::path& pdf);

}  // namespace lipofill::client
