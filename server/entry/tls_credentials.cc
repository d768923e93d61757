#include "server/entry/tls_credentials.h"

#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>

namespace lipofill::server {

std::shared_ptr<grpc::ServerCredentials> make_tls_credentials(const SecuritySettings& settings) {
  constexpr unsigned int kLookEverySeconds = 1;
  const bool asks_clients = !settings.tls_client_ca_file.empty();
  const auto files = std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
      settings.tls_key_file, settings.tls_certificate_file, settings.tls_client_ca_file, kLookEverySeconds);
  grpc::experimental::TlsServerCredentialsOptions options(files);
  options.watch_identity_key_cert_pairs();
  if (asks_clients) {
    options.watch_root_certs();
    options.set_cert_request_type(settings.tls_client_certificate_optional
                                      ? GRPC_SSL_REQUEST_CLIENT_CERTIFICATE_AND_VERIFY
                                      : GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  }
  return grpc::experimental::TlsServerCredentials(options);
}

}  // namespace lipofill::server
