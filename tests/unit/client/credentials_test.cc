#include "client/cpp/credentials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "tests/unit/server/temporary_directory.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

class CredentialsTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) {
    std::ofstream(directory_.file(name)) << text;
    return directory_.file(name);
  }
  static std::string refusal(const CredentialFiles& files, const std::string& server = "far:50061") {
    const auto credentials = read_credentials(files, server);
    EXPECT_TRUE(credentials.ok() || absl::IsInvalidArgument(credentials.status()));
    return credentials.ok() ? "" : std::string(credentials.status().message());
  }
  const std::string certificate_ = "-----BEGIN CERTIFICATE-----\nCERT";
  lipofill::testing::TemporaryDirectory directory_;
};

TEST_F(CredentialsTest, AreWhatTheFilesHold) {
  const std::string key = "-----BEGIN EC PRIVATE KEY-----\nKEY";
  const auto credentials = read_credentials({write("token", "a.b.c\n"), write("ca", certificate_),
                                             write("cert", "subject\n" + certificate_), write("key", key)},
                                            "far:1");
  ASSERT_TRUE(credentials.ok()) << credentials.status();
  EXPECT_EQ(credentials->token_file, directory_.file("token"));
  EXPECT_EQ(credentials->ca_pem, certificate_);
  EXPECT_EQ(credentials->cert_pem, "subject\n" + certificate_);
  EXPECT_EQ(credentials->key_pem, key);
  EXPECT_EQ(refusal({}), "");
}

TEST_F(CredentialsTest, ATokenDoesNotLeaveTheMachineUnencrypted) {
  const std::string token = write("token", "a.b.c");
  for (const char* here : {"127.0.0.1:50061", "localhost:1", "[::1]:1", "unix:/run/lipofill.sock"}) {
    EXPECT_EQ(refusal({.token = token}, here), "") << here;
  }
  for (const char* there : {"far:50061", "10.0.0.1:1", "localhost.example.org:1", "dns:///127.0.0.1:1"}) {
    EXPECT_THAT(refusal({.token = token}, there), HasSubstr("unencrypted: give --tls-ca")) << there;
  }
}

TEST_F(CredentialsTest, MistakesAreNamed) {
  const std::string pem = write("pem", certificate_);
  EXPECT_THAT(refusal({.tls_ca = pem, .tls_cert = pem}), HasSubstr("both --tls-cert and --tls-key"));
  EXPECT_THAT(refusal({.tls_cert = pem, .tls_key = pem}), HasSubstr("needs --tls-ca"));
  EXPECT_THAT(refusal({.tls_ca = directory_.file("none")}), HasSubstr(directory_.file("none")));
  EXPECT_THAT(refusal({.token = directory_.file("none"), .tls_ca = pem}), HasSubstr(directory_.file("none")));
  for (const char* bad : {"", "\n", "two tokens", "a\nb"}) {
    EXPECT_THAT(refusal({.token = write("bad", bad), .tls_ca = pem}), HasSubstr("one token and nothing else")) << bad;
  }
  EXPECT_THAT(refusal({.tls_ca = write("bad", "solid half_face\n")}), HasSubstr("holds no certificate in PEM"));
  EXPECT_THAT(refusal({.tls_ca = pem, .tls_cert = pem, .tls_key = pem}), HasSubstr("holds no private key in PEM"));
}

TEST_F(CredentialsTest, ComeFromTheEnvironment) {
  const char* const names[] = {"LIPOFILL_TOKEN_FILE", "LIPOFILL_TLS_CA", "LIPOFILL_TLS_CERT", "LIPOFILL_TLS_KEY"};
  for (const char* name : names) ASSERT_EQ(setenv(name, name, 1), 0);
  const CredentialFiles files = credential_files_of_environment();
  EXPECT_EQ(files.token, names[0]);
  EXPECT_EQ(files.tls_ca, names[1]);
  EXPECT_EQ(files.tls_cert, names[2]);
  EXPECT_EQ(files.tls_key, names[3]);
  for (const char* name : names) ASSERT_EQ(unsetenv(name), 0);
  EXPECT_EQ(credential_files_of_environment().token, "");
}

}  // namespace
}  // namespace lipofill::client
