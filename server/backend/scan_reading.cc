#include "server/backend/scan_reading.h"

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
#include "lipofill/v1/patient_service.pb.h"
#include "server/store/record_names.h"

namespace lipofill::server {
namespace {

geometry::SurfaceFormat format_of(const ScanRecord& scan) {
  switch (scan.format) {
    case v1::PLY:
      return geometry::SurfaceFormat::kPly;
    case v1::STL:
      return geometry::SurfaceFormat::kStl;
    default:
      return geometry::SurfaceFormat::kObj;
  }
}

double metres_per_unit(const ScanRecord& scan) {
  switch (scan.unit) {
    case v1::METRE:
      return 1.0;
    case v1::CENTIMETRE:
      return kMetresPerCentimetre;
    default:
      return kMetresPerMillimetre;
  }
}

}  // namespace

absl::StatusOr<geometry::ScannedSurface> parse_scan(const ScanRecord& scan, std::string_view bytes) {
  return geometry::read_surface(bytes, format_of(scan), metres_per_unit(scan));
}

absl::Status check_complete(Backend& backend, const std::string& patient, const std::string& scan,
                            const std::string& field) {
  const auto record = backend.store.get_scan(patient, scan);
  if (!record.ok()) return record.status();
  if (record->complete) return absl::OkStatus();
  return field_violation(field,
                         absl::StrCat("is ", scan_name(patient, scan), ", which is not complete: ",
                                      record->received_bytes, " of ", record->size_bytes, " bytes are here"),
                         absl::StatusCode::kFailedPrecondition);
}

absl::StatusOr<geometry::ScannedSurface> read_scan_surface(Backend& backend, const std::string& patient,
                                                           const std::string& scan) {
  const auto record = backend.store.get_scan(patient, scan);
  if (!record.ok()) return record.status();
  if (!record->complete) {
    return absl::FailedPreconditionError(absl::StrCat(scan_name(patient, scan),
                                                      " is not complete: ", record->received_bytes, " of ",
                                                      record->size_bytes, " bytes are here"));
  }
  const auto bytes = backend.scan_files.read_whole(patient, scan, record->sha256);
  if (!bytes.ok()) return bytes.status();
  return parse_scan(*record, *bytes);
}

}  // namespace lipofill::server
