#pragma once

#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "client/cpp/connection.h"
#include "client/cpp/picture/result_picture.h"
#include "lipofill/v1/planning_service.pb.h"

namespace lipofill::client {

/// Draws what a face lacks on one sheet, in a process of its own.
/// @param deficit  with a distance a vertex of the scan
/// @param target   of the scan, for its landmarks and its name
absl::Status draw_deficit_sheet(const Connection& connection, const v1::TargetSpec& target, const v1::Deficit& deficit,
                                const std::filesystem::path& png);

/// Reads what that process draws from the folder that it is given.
absl::StatusOr<PictureRequest> read_deficit_request(const std::filesystem::path& folder);

}  // namespace lipofill::client
