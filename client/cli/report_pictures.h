#pragma once

#include <filesystem>

#include "client/cli/report_fetch.h"
#include "client/cpp/report/report_document.h"

namespace lipofill::client {

/// Draws all pictures of a report in a process of its own, and reads them. Where they cannot be
/// drawn, ReportPictures.problem says why: a report is then one of words and figures.
ReportPictures draw_report_pictures(const ReportFetch& fetch);

/// Does the work of that process: it draws the pictures that the folder asks for, into the folder.
absl::Status draw_pictures_of_report(const std::filesystem::path& folder);

}  // namespace lipofill::client
