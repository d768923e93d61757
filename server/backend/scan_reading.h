#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/geometry/surface_reader.h"
#include "server/backend/backend.h"
#include "server/store/records.h"

namespace lipofill::server {

/// The surface of a scan's bytes, in metres. Errors as those of geometry::read_surface.
absl::StatusOr<geometry::ScannedSurface> parse_scan(const ScanRecord& scan, std::string_view bytes);

/// FAILED_PRECONDITION with a violation of `field` where a scan of the patient is not complete yet,
/// NOT_FOUND where there is none.
absl::Status check_complete(Backend& backend, const std::string& patient, const std::string& scan,
                            const std::string& field);

/// The surface of a scan in the store. FAILED_PRECONDITION while it is not complete.
absl::StatusOr<geometry::ScannedSurface> read_scan_surface(Backend& backend, const std::string& patient,
                                                           const std::string& scan);

}  // namespace lipofill::server
