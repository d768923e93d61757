#pragma once

#include "absl/status/status.h"
#include "server/security/security_settings.h"

namespace lipofill::server {

/// Checks that the files of certificates and keys can be used: they are PEM, the key is the
/// certificate's, the certificate is within its time. gRPC itself only fails handshakes later.
/// Field violations by the names of the settings. Checked by
/// tests/integration/security/settings_test.cc.
absl::Status check_tls_files(const SecuritySettings& settings);

}  // namespace lipofill::server
