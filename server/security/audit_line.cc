#include "server/security/audit_line.h"

#include <nlohmann/json.hpp>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "core/base/hash.h"

namespace lipofill::server {

std::string hash_of_line(std::string_view line) {
  Hasher hasher;
  hasher.add_bytes(line.data(), line.size());
  return hasher.hex_digest();
}

std::string make_audit_line(const AuditEntry& entry, const AuditHead& head) {
  const nlohmann::ordered_json line = {
      {"number", head.number + 1},
      {"time", absl::FormatTime("%Y-%m-%dT%H:%M:%E6SZ", absl::Now(), absl::UTCTimeZone())},
      {"subject", entry.subject},
      {"tenant", entry.tenant},
      {"role", entry.role},
      {"method", entry.method},
      {"resources", entry.resources},
      {"made", entry.made},
      {"outcome", entry.outcome},
      {"request_id", entry.request_id},
      {"previous", head.hash}};
  // Bytes that are no UTF-8 become replacement characters: a line is always JSON.
  return line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

bool read_audit_line(std::string_view line, AuditHead& told) {
  const auto object = nlohmann::json::parse(line, nullptr, false);
  if (!object.is_object() || !object.contains("number") || !object.contains("previous")) return false;
  if (!object["number"].is_number_unsigned() || !object["previous"].is_string()) return false;
  told.number = object["number"].get<uint64_t>();
  told.hash = object["previous"].get<std::string>();
  return true;
}

}  // namespace lipofill::server
