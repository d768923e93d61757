#include "server/wire/etag.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/base/hash.h"

namespace lipofill::server {
namespace {

constexpr size_t kDigits = 16;
constexpr size_t kMaxShown = 64;

std::string shorten(Hasher& hasher) {
  return hasher.hex_digest().substr(0, kDigits);
}

}  // namespace

std::string make_etag(const PatientRecord& patient) {
  Hasher hasher;
  hasher.add(patient.display_name);
  for (const auto& [key, value] : patient.labels) {
    hasher.add(key);
    hasher.add(value);
  }
  return shorten(hasher);
}

std::string make_etag(const SimulationRecord& simulation) {
  Hasher hasher;
  hasher.add(simulation.last_command);
  hasher.add(static_cast<int>(simulation.state));
  return shorten(hasher);
}

absl::Status check_etag(const std::string& given, const std::string& present, const std::string& field) {
  if (given.empty() || given == present) return absl::OkStatus();
  return field_violation(field,
                         absl::StrCat("is \"", given.substr(0, kMaxShown), "\", the present one is \"", present,
                                      "\": it was changed meanwhile; read it again"),
                         absl::StatusCode::kAborted);
}

}  // namespace lipofill::server
