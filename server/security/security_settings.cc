#include "server/security/security_settings.h"

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "server/security/anchor_key.h"
#include "server/security/authenticator.h"
#include "server/security/tls_files.h"

namespace lipofill::server {
namespace {

void need(bool is_there, const char* setting, const char* why, FieldViolations& violations) {
  if (!is_there) violations.add(setting, absl::StrCat("is missing: ", why));
}

void check_together(const SecuritySettings& settings, FieldViolations& violations) {
  const bool has_key = !settings.tls_key_file.empty();
  const bool has_client_ca = !settings.tls_client_ca_file.empty();
  if (has_key || has_client_ca) need(settings.has_tls(), "tls-certificate-file", "TLS needs it", violations);
  if (settings.has_tls()) need(has_key, "tls-key-file", "it belongs to tls-certificate-file", violations);
  if (settings.has_certificates()) {
    need(has_client_ca, "tls-client-ca-file", "client-certificates-file says who holds what it has signed", violations);
  }
  if (has_client_ca) {
    need(settings.has_authentication(), "client-certificates-file", "nobody is known by their client certificate",
         violations);
  }
  if (!settings.revoked_file.empty()) {
    need(settings.has_authentication(), "token-keys-file", "revoked-file is of callers who say who they are",
         violations);
  }
  if (settings.has_tokens()) {
    need(!settings.token_issuer.empty(), "token-issuer", "token-keys-file needs it", violations);
    need(!settings.token_audience.empty(), "token-audience", "token-keys-file needs it", violations);
  }
}

}  // namespace

std::string SecuritySettings::audit_file_in(const std::string& data_directory) const {
  if (!audit_file.empty() || !has_authentication()) return audit_file;
  return data_directory + "/audit.jsonl";
}

absl::Status check_security(const SecuritySettings& settings) {
  FieldViolations violations;
  check_together(settings, violations);
  violations.absorb("", check_tls_files(settings));
  violations.absorb("", Authenticator::open(settings).status());
  if (!settings.audit_key_file.empty()) {
    const auto key = AnchorKey::open(settings.audit_key_file);
    if (!key.ok()) violations.add("audit-key-file", std::string(key.status().message()));
  }
  return violations.to_status();
}

}  // namespace lipofill::server
