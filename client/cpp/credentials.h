#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/support/channel_arguments.h>

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lipofill::client {

/// Files by which a client says who it is, and knows the daemon. Secrets come from files, never
/// from a command line, which every user of a machine can read.
struct CredentialFiles {
  std::string token;     ///< a bearer token; read again for every call, so that it may be renewed
  std::string tls_ca;    ///< PEM: authorities of the daemon's certificate; with it the connection is encrypted
  std::string tls_cert;  ///< PEM: the client's own certificate, with tls_key
  std::string tls_key;
};

/// The files named by LIPOFILL_TOKEN_FILE, LIPOFILL_TLS_CA, LIPOFILL_TLS_CERT and LIPOFILL_TLS_KEY,
/// if they are set.
CredentialFiles credential_files_of_environment();

/// Content of the credential files.
struct Credentials {
  std::string token_file;
  std::string ca_pem;
  std::string cert_pem;
  std::string key_pem;
};

/// Reads the files. INVALID_ARGUMENT naming the one that cannot be read or is missing beside
/// another, and for a token that would travel unencrypted to another machine. Checked by
/// tests/unit/client/credentials_test.cc.
absl::StatusOr<Credentials> read_credentials(const CredentialFiles& files, const std::string& server);

/// A channel whose calls carry the credentials.
std::shared_ptr<grpc::Channel> open_channel(const std::string& server, const Credentials& credentials,
                                            const grpc::ChannelArguments& arguments);

}  // namespace lipofill::client
