#include "server/ops/security_options.h"

#include <iostream>

#include "server/security/audit_log.h"

namespace lipofill::server {

std::vector<Setting> settings_of(SecuritySettings& security) {
  return {
      {"tls-certificate-file", "PATH",
       "PEM: the certificate to show on TCP, then those between it and its authority; read again when it changes",
       &security.tls_certificate_file},
      {"tls-key-file", "PATH", "PEM: the certificate's private key; read again when it changes",
       &security.tls_key_file},
      {"tls-client-ca-file", "PATH", "PEM: authorities of client certificates, which callers on TCP must then show",
       &security.tls_client_ca_file},
      {"tls-client-certificate-optional", "", "Callers on TCP may do without a client certificate, by a token alone",
       &security.tls_client_certificate_optional},
      {"client-certificates-file", "PATH", "JSON: who holds which client certificate; read again when it changes",
       &security.client_certificates_file},
      {"token-keys-file", "PATH",
       "Public keys that bearer tokens (JWT: RS256, ES256, EdDSA) are signed with, PEM or JWKS; read again when it "
       "changes",
       &security.token_keys_file},
      {"token-issuer", "TEXT", "What tokens must have as iss", &security.token_issuer},
      {"token-audience", "TEXT", "What tokens must have as aud, or in it", &security.token_audience},
      {"revoked-file", "PATH",
       "JSON: tokens and callers that are no longer good, whose calls also end; read again when it changes",
       &security.revoked_file},
      {"token-clock-skew-s", "SECONDS", "How far the clocks of this machine and the tokens' issuer may be apart",
       &security.token_clock_skew_s, 0, 300},
      {"trust-unix-sockets", "",
       "Callers on UNIX sockets who do not say who they are are admin of the tenant local, as without authentication",
       &security.trust_unix_sockets},
      {"audit-file", "PATH",
       "Audit log, a line of JSON a call; default: audit.jsonl in the data directory where callers must say who they "
       "are, else none",
       &security.audit_file},
      {"audit-key-file", "PATH",
       "PEM, a private key: signs the anchor beside the audit log, which shows that its end was cut off",
       &security.audit_key_file},
      {"audit-rotate-mb", "MB", "Size at which the audit log goes on in a new file; nothing is ever deleted",
       &security.audit_rotate_mb, 1, 1e6},
  };
}

namespace {

absl::StatusOr<std::optional<AuditHead>> read_anchor_of(const std::string& log, const std::string& key_file) {
  const std::string path = AuditAnchor::path_of(log);
  if (key_file.empty()) return read_anchor(path, nullptr);
  const auto key = AnchorKey::open_to_verify(key_file);
  if (!key.ok()) return key.status();
  auto anchor = read_anchor(path, &*key);
  if (anchor.ok() && !*anchor) return absl::DataLossError(path + ", which audit-key-file signs, is not there");
  return anchor;
}

}  // namespace

int print_audit_verification(const std::vector<std::string>& files, const std::string& key_file) {
  const auto anchor = read_anchor_of(files.back(), key_file);
  const auto summary = anchor.ok() ? verify_audit(files, *anchor) : anchor.status();
  if (!summary.ok()) {
    std::cerr << "lipofilld: " << summary.status().message() << "\n";
    return 1;
  }
  std::cout << summary->lines << " lines, each carries on from the one before; the first from line "
            << summary->before.number << ", hash " << summary->before.hash << "\n";
  if (summary->torn_lines > 0) std::cout << summary->torn_lines << " were cut short as they were written\n";
  std::cout << "the last is line " << summary->head.number << ", hash " << summary->head.hash
            << ": compare it with the daemon's log\n";
  if (*anchor) {
    std::cout << "the anchor has line " << (*anchor)->number << ", which is there"
              << (key_file.empty() ? "; whether it was signed was not asked" : ", and is signed") << "\n";
  } else {
    std::cout << "there is no anchor beside it: whether its end was cut off cannot be told\n";
  }
  return 0;
}

}  // namespace lipofill::server
