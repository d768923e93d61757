#pragma once

#include "absl/status/status.h"
#include "server/security/security_settings.h"

namespace lipofill::server {

/// Whether the files of certificates and keys can be used: PEM, the key the certificate's, the certificate in its time.
/// gRPC itself only fails handshakes later. Field violations by the names of the settings.
/// Checked by tests/integration/security/settings_test.cc.
absl::Status check_tls_files(const SecuritySettings& settings);

}  // namespace lipofill::server
