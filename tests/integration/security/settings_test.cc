// What the daemon says of settings and files of secrets that do not fit, before it serves anybody.

#include <fstream>

#include "tests/integration/cli/shell.h"
#include "tests/integration/security/secure_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

class SecuritySettingsTest : public ::testing::Test {
 protected:
  SecuritySettingsTest() {
    const std::string make = std::string(LIPOFILL_DEPLOY) + "/make_certificates ";
    EXPECT_EQ(run_shell(make + directory_.file("a")).exit_code, 0);
    EXPECT_EQ(run_shell(make + directory_.file("b")).exit_code, 0);
  }
  std::string file(const std::string& name) const { return directory_.file(name); }
  /// What --check says; "" where it finds nothing wrong.
  std::string complaint(std::vector<std::string> arguments) {
    arguments.push_back("--check");
    std::string output;
    return run_daemon_to_end(arguments, output) == 0 ? "" : output;
  }
  std::vector<std::string> tls() const {
    return {"--tls-certificate-file", file("a/server.pem"), "--tls-key-file", file("a/server.key")};
  }
  std::vector<std::string> tokens() const {
    return {"--token-keys-file", file("a/token-keys.pem"), "--token-issuer", "i", "--token-audience", "a"};
  }
  static std::vector<std::string> both(std::vector<std::string> one, const std::vector<std::string>& other) {
    one.insert(one.end(), other.begin(), other.end());
    return one;
  }
  TemporaryDirectory directory_;
};

TEST_F(SecuritySettingsTest, GoodOnesAreGood) {
  EXPECT_EQ(complaint(both(tls(), tokens())), "");
  EXPECT_EQ(complaint(tokens()), "") << "plain text on loopback, behind a proxy that encrypts";
  EXPECT_EQ(complaint(tls()), "");
  const std::string holders = std::string(LIPOFILL_DEPLOY) + "/client_certificates.json";
  EXPECT_EQ(complaint(both(tls(), {"--tls-client-ca-file", file("a/ca.pem"), "--client-certificates-file", holders})),
            "")
      << "the sample is good";
}

TEST_F(SecuritySettingsTest, TheNetworkIsServedEncryptedAndToWhoIsKnown) {
  const std::vector<std::string> anywhere = {"--listen", "0.0.0.0:0"};
  const std::vector<std::string> with_tokens = both(both(tls(), tokens()), anywhere);
  EXPECT_THAT(complaint(with_tokens), HasSubstr("strangers can exhaust the daemon")) << "without a front";
  EXPECT_EQ(complaint(both(with_tokens, {"--behind-proxy"})), "");
  EXPECT_EQ(complaint(both(with_tokens, {"--insecure-listen-anywhere"})), "");
  const std::string holders = std::string(LIPOFILL_DEPLOY) + "/client_certificates.json";
  const std::vector<std::string> with_certificates =
      both(both(tls(), anywhere), {"--tls-client-ca-file", file("a/ca.pem"), "--client-certificates-file", holders});
  EXPECT_EQ(complaint(with_certificates), "") << "strangers get no further than the handshake";
  EXPECT_THAT(complaint(both(with_certificates, {"--tls-client-certificate-optional"})), HasSubstr("strangers"));
  EXPECT_THAT(complaint(both(tls(), anywhere)), HasSubstr("others on the network reach"));
  EXPECT_THAT(complaint(both(tokens(), anywhere)), HasSubstr("others on the network reach"));
}

TEST_F(SecuritySettingsTest, WhatBelongsTogetherIsThere) {
  EXPECT_THAT(complaint({"--tls-key-file", file("a/server.key")}), HasSubstr("tls-certificate-file: is missing"));
  EXPECT_THAT(complaint({"--tls-certificate-file", file("a/server.pem")}), HasSubstr("tls-key-file: is missing"));
  EXPECT_THAT(complaint({"--token-keys-file", file("a/token-keys.pem")}), HasSubstr("token-issuer: is missing"));
  EXPECT_THAT(complaint({"--token-keys-file", file("a/token-keys.pem")}), HasSubstr("token-audience: is missing"));
  EXPECT_THAT(complaint(both(tls(), {"--tls-client-ca-file", file("a/ca.pem")})),
              HasSubstr("client-certificates-file: is missing"));
}

TEST_F(SecuritySettingsTest, FilesThatCannotBeUsedAreNamed) {
  EXPECT_THAT(complaint({"--tls-certificate-file", file("a/server.pem"), "--tls-key-file", file("b/server.key")}),
              HasSubstr("which is not the key of tls-certificate-file"));
  EXPECT_THAT(complaint({"--tls-certificate-file", file("none"), "--tls-key-file", file("a/server.pem")}),
              ::testing::AllOf(HasSubstr("tls-certificate-file: is"), HasSubstr("cannot be read"),
                               HasSubstr("no PEM block PRIVATE KEY")));
  EXPECT_THAT(complaint({"--token-keys-file", file("a/token.key"), "--token-issuer", "i", "--token-audience", "a"}),
              HasSubstr("token-keys-file: a private key does not belong here"));
  EXPECT_THAT(complaint(both(tokens(), {"--token-clock-skew-s", "301"})), HasSubstr("an integer in [0, 300]"));
  std::ofstream(file("holders")) << R"({"certificates": [{"common_name": "a"}]})";
  EXPECT_THAT(
      complaint(both(tls(), {"--tls-client-ca-file", file("a/ca.pem"), "--client-certificates-file", file("holders")})),
      HasSubstr("certificates[0]: tenant must match"));
  const std::string request =
      "openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=old -keyout " + file("old.key") +
      " -out " + file("old.csr") + " 2> /dev/null";
  const std::string sign = "openssl x509 -req -in " + file("old.csr") + " -signkey " + file("old.key") +
                           " -days -1 -out " + file("old.pem") + " 2> /dev/null";
  ASSERT_EQ(run_shell(request + " && " + sign).exit_code, 0);
  EXPECT_THAT(complaint({"--tls-certificate-file", file("old.pem"), "--tls-key-file", file("old.key")}),
              HasSubstr("whose certificate has expired"));
}

}  // namespace
}  // namespace lipofill::testing
