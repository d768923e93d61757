#include "server/backend/model_reading.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "server/backend/scan_reading.h"
#include "server/store/record_names.h"
#include "server/wire/model_conversion.h"
#include "server/wire/names.h"

namespace lipofill::server {
namespace {

absl::StatusOr<std::string> scan_of(const std::string& patient, const std::string& name, const std::string& field) {
  const auto scan = parse_scan_name(name, field);
  if (!scan.ok()) return scan.status();
  if (scan->patient != patient) {
    return field_violation(field, absl::StrCat("is ", name, ", must be a scan of ", patient_name(patient)));
  }
  return scan->id;
}

}  // namespace

absl::StatusOr<ScanIds> scans_of(const std::string& patient, const v1::ModelSpec& spec) {
  ScanIds ids;
  if (!spec.has_scan_region()) return ids;
  FieldViolations violations;
  const auto skin = scan_of(patient, spec.scan_region().scan(), "scan_region.scan");
  violations.absorb("", skin.status());
  if (skin.ok()) ids.skin = *skin;
  if (!spec.scan_region().bone_scan().empty()) {
    const auto bone = scan_of(patient, spec.scan_region().bone_scan(), "scan_region.bone_scan");
    violations.absorb("", bone.status());
    if (bone.ok()) ids.bone = *bone;
  }
  if (!violations.empty()) return violations.to_status();
  return ids;
}

absl::Status read_scans(Backend& backend, const std::string& patient, const ScanIds& scans,
                        model::FaceModelSpec& spec) {
  if (scans.skin.empty()) return absl::OkStatus();
  auto surface = read_scan_surface(backend, patient, scans.skin);
  if (!surface.ok()) return surface.status();
  std::get<geometry::ScanRegionSpec>(spec.region).scan = *std::move(surface);
  if (scans.bone.empty()) return absl::OkStatus();
  auto bone = read_scan_surface(backend, patient, scans.bone);
  if (!bone.ok()) return bone.status();
  spec.bone = *std::move(bone);
  return absl::OkStatus();
}

absl::StatusOr<model::FaceModelSpec> read_model_spec(Backend& backend, const std::string& patient,
                                                     const v1::ModelSpec& message) {
  auto spec = to_face_model_spec(message);
  if (!spec.ok()) return spec.status();
  const auto scans = scans_of(patient, message);
  if (!scans.ok()) return scans.status();
  if (absl::Status read = read_scans(backend, patient, *scans, *spec); !read.ok()) return read;
  return spec;
}

}  // namespace lipofill::server
