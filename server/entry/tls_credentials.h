#pragma once

#include <grpcpp/security/server_credentials.h>

#include <memory>

#include "server/security/security_settings.h"

namespace lipofill::server {

/// TLS 1.2 or 1.3 with the certificate, key and client authorities of the settings, whose files are
/// looked at again once a second: connections made after a change have the new ones. Write a new
/// key and certificate as one file and give it for both, or change both within that second: in
/// between, handshakes fail. Checked by tests/integration/security/tls_test.cc.
std::shared_ptr<grpc::ServerCredentials> make_tls_credentials(const SecuritySettings& settings);

}  // namespace lipofill::server
