#include "client/cpp/credentials.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/client_interceptor.h>

#include <cstdlib>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/json_file.h"

namespace lipofill::client {
namespace {

using grpc::experimental::InterceptionHookPoints;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// Reads a PEM file. It is checked here because gRPC says of a bad one only that nobody answers.
absl::Status take_pem(const std::string& path, const char* what, const char* mark, std::string& text) {
  if (path.empty()) return absl::OkStatus();
  auto read = read_text_file(path);
  if (!read.ok()) return read.status();
  if (!absl::StrContains(*read, mark)) {
    return absl::InvalidArgumentError(absl::StrCat(path, " holds no ", what, " in PEM, which begins with -----BEGIN"));
  }
  text = *std::move(read);
  return absl::OkStatus();
}

absl::StatusOr<std::string> read_token(const std::string& path) {
  const auto text = read_text_file(path);
  if (!text.ok()) return text.status();
  const std::string token(absl::StripAsciiWhitespace(*text));
  const bool fits = !token.empty() && token.find_first_of(" \t\r\n") == std::string::npos;
  return fits ? absl::StatusOr<std::string>(token)
              : absl::InvalidArgumentError(absl::StrCat(path, " must have one token and nothing else"));
}

/// True for an address to which nothing leaves the machine.
bool is_local(const std::string& server) {
  return absl::StartsWith(server, "unix:") || absl::StartsWith(server, "127.") ||
         absl::StartsWith(server, "localhost:") || absl::StartsWith(server, "[::1]:");
}

/// Puts the token into the metadata of a call.
class TokenCarrier : public grpc::experimental::Interceptor {
 public:
  explicit TokenCarrier(const std::string& file) : file_(file) {}

  void Intercept(grpc::experimental::InterceptorBatchMethods* batch) override {
    if (batch->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_INITIAL_METADATA)) {
      const auto token = read_token(file_);
      if (token.ok()) batch->GetSendInitialMetadata()->emplace("authorization", absl::StrCat("Bearer ", *token));
    }
    batch->Proceed();
  }

 private:
  const std::string& file_;
};

class TokenCarriers : public grpc::experimental::ClientInterceptorFactoryInterface {
 public:
  explicit TokenCarriers(std::string file) : file_(std::move(file)) {}
  grpc::experimental::Interceptor* CreateClientInterceptor(grpc::experimental::ClientRpcInfo*) override {
    return new TokenCarrier(file_);
  }

 private:
  const std::string file_;
};

}  // namespace

CredentialFiles credential_files_of_environment() {
  return {variable("LIPOFILL_TOKEN_FILE"), variable("LIPOFILL_TLS_CA"), variable("LIPOFILL_TLS_CERT"),
          variable("LIPOFILL_TLS_KEY")};
}

absl::StatusOr<Credentials> read_credentials(const CredentialFiles& files, const std::string& server) {
  if (files.tls_cert.empty() != files.tls_key.empty()) {
    return absl::InvalidArgumentError("a client certificate needs both --tls-cert and --tls-key");
  }
  if (!files.tls_cert.empty() && files.tls_ca.empty()) {
    return absl::InvalidArgumentError("a client certificate needs --tls-ca, the authority of the daemon's");
  }
  if (!files.token.empty() && files.tls_ca.empty() && !is_local(server)) {
    return absl::InvalidArgumentError(absl::StrCat("a token does not go to ", server,
                                                   " unencrypted: give --tls-ca, the authority of its certificate"));
  }
  Credentials credentials;
  credentials.token_file = files.token;
  absl::Status read = files.token.empty() ? absl::OkStatus() : read_token(files.token).status();
  read.Update(take_pem(files.tls_ca, "certificate", "BEGIN CERTIFICATE-----", credentials.ca_pem));
  read.Update(take_pem(files.tls_cert, "certificate", "BEGIN CERTIFICATE-----", credentials.cert_pem));
  read.Update(take_pem(files.tls_key, "private key", "PRIVATE KEY-----", credentials.key_pem));
  if (!read.ok()) return read;
  return credentials;
}

std::shared_ptr<grpc::Channel> open_channel(const std::string& server, const Credentials& credentials,
                                            const grpc::ChannelArguments& arguments) {
  const auto transport = credentials.ca_pem.empty()
                             ? grpc::InsecureChannelCredentials()
                             : grpc::SslCredentials({credentials.ca_pem, credentials.key_pem, credentials.cert_pem});
  std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>> carriers;
  if (!credentials.token_file.empty()) carriers.push_back(std::make_unique<TokenCarriers>(credentials.token_file));
  return grpc::experimental::CreateCustomChannelWithInterceptors(server, transport, arguments, std::move(carriers));
}

}  // namespace lipofill::client
