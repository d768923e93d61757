// TLS, mutual TLS and client certificates, made with openssl by deploy/make_certificates as anybody
// would.

#include <fstream>
#include <thread>

#include "tests/integration/cli/shell.h"
#include "tests/integration/security/secure_fixture.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kHolders[] = R"({"certificates": [
  {"common_name": "wall", "tenant": "ward", "roles": ["viewer"]},
  {"alternative_name": "gate.ward.example", "tenant": "ward", "roles": ["planner"]}]})";

class TlsTest : public SecureTest {
 protected:
  TlsTest() {
    make("");
    make("client wall");
    make("client stranger");
    std::ofstream(file("holders.json")) << kHolders;
  }
  std::string file(const std::string& name) const { return directory_.file("secrets/" + name); }
  std::string pem(const std::string& name) const { return read_whole_file(file(name)); }
  void make(const std::string& what, const std::string& folder = "secrets") {
    const CommandResult made =
        run_shell(std::string(LIPOFILL_DEPLOY) + "/make_certificates " + directory_.file(folder) + " " + what);
    EXPECT_EQ(made.exit_code, 0) << made.errors;
  }
  /// With the server's certificate, and more arguments.
  void start_with_tls(std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--tls-certificate-file", file("server.pem"), "--tls-key-file", file("server.key")});
    start(more);
  }
  void start_with_client_certificates(std::vector<std::string> more = {}) {
    more.insert(more.end(),
                {"--tls-client-ca-file", file("ca.pem"), "--client-certificates-file", file("holders.json")});
    start_with_tls(more);
  }
  std::string address() const { return "localhost:" + daemon_->address().substr(daemon_->address().find(':') + 1); }

  /// Somebody who shows this client's certificate (none where empty), from the folder, and trusts
  /// the authority in `ca`.
  Caller client(const std::string& name, const std::string& token = "", const std::string& ca = "secrets/ca.pem",
                const std::string& folder = "secrets/") {
    grpc::SslCredentialsOptions options{read_whole_file(directory_.file(ca)), "", ""};
    if (!name.empty()) {
      options.pem_private_key = read_whole_file(directory_.file(folder + name + ".key"));
      options.pem_cert_chain = read_whole_file(directory_.file(folder + name + ".pem"));
    }
    grpc::ChannelArguments own;
    own.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return {grpc::CreateCustomChannel(address(), grpc::SslCredentials(options), own), token};
  }
  static Answer list(const Caller& someone) { return someone.call_json("PatientService/ListPatients", "{}"); }
  static Answer create(const Caller& someone) { return someone.call_json("PatientService/CreatePatient", "{}"); }
};

TEST_F(TlsTest, EncryptsAndShowsItsCertificate) {
  start_with_tls();
  const std::string viewer = token(claims("ward", "viewer"));
  EXPECT_TRUE(list(client("", viewer)).status.ok()) << list(client("", viewer)).status.error_message();
  EXPECT_EQ(list(client("")).reason(), "NO_CREDENTIALS");
  EXPECT_TRUE(client("").call_bytes("/grpc.health.v1.Health/Check", "").status.ok());
  EXPECT_EQ(list(bearer(viewer)).code(), StatusCode::UNAVAILABLE) << "plain text gets nowhere";
  make("", "others");
  EXPECT_EQ(list(client("", viewer, "others/ca.pem")).code(), StatusCode::UNAVAILABLE) << "another authority's client";
}

TEST_F(TlsTest, ClientCertificatesAreRequiredAndSayWho) {
  start_with_client_certificates();
  EXPECT_TRUE(list(client("client-wall")).status.ok()) << list(client("client-wall")).status.error_message();
  EXPECT_EQ(create(client("client-wall")).reason(), "ROLE_TOO_LOW");
  EXPECT_EQ(list(client("client-stranger")).reason(), "CERTIFICATE_UNKNOWN");
  EXPECT_EQ(list(client("")).code(), StatusCode::UNAVAILABLE) << "no certificate, no connection";
  EXPECT_EQ(list(client("", token(claims("ward", "admin")))).code(), StatusCode::UNAVAILABLE);
  make("", "others");
  make("client wall", "others");
  EXPECT_EQ(list(client("client-wall", "", "secrets/ca.pem", "others/")).code(), StatusCode::UNAVAILABLE)
      << "the right name signed by another authority";
  const std::string planner = token(claims("ward", "planner"));
  EXPECT_TRUE(create(client("client-wall", planner)).status.ok()) << "who sits at the machine says more than it";
  EXPECT_TRUE(create(client("client-stranger", planner)).status.ok());
  EXPECT_EQ(list(client("client-wall", token(claims("clinic", "planner")))).reason(), "CREDENTIALS_DISAGREE");
}

TEST_F(TlsTest, AlternativeNamesAreNamesToo) {
  start_with_client_certificates();
  const std::string csr = "openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=any -keyout " +
                          file("gate.key") + " -out " + file("gate.csr");
  const std::string sign = "printf 'subjectAltName = DNS:gate.ward.example' > " + file("san") +
                           " && openssl x509 -req -in " + file("gate.csr") + " -CA " + file("ca.pem") + " -CAkey " +
                           file("ca.key") + " -extfile " + file("san") + " -out " + file("gate.pem");
  ASSERT_EQ(run_shell("{ " + csr + " && " + sign + "; } 2> /dev/null").exit_code, 0);
  EXPECT_TRUE(create(client("gate")).status.ok());
}

TEST_F(TlsTest, ClientCertificatesMayBeOptionalBesideTokens) {
  start_with_client_certificates({"--tls-client-certificate-optional"});
  EXPECT_TRUE(list(client("", token(claims("ward", "viewer")))).status.ok());
  EXPECT_TRUE(list(client("client-wall")).status.ok());
  EXPECT_EQ(list(client("")).reason(), "NO_CREDENTIALS");
}

TEST_F(TlsTest, NewCertificatesKeysAndHoldersAreTakenWhileItRuns) {
  start_with_client_certificates();
  ASSERT_TRUE(list(client("client-wall")).status.ok());
  ASSERT_EQ(list(client("client-stranger")).reason(), "CERTIFICATE_UNKNOWN");
  const std::string before = pem("server.pem");
  std::filesystem::rename(file("ca.pem"), file("old-ca.pem"));
  std::filesystem::remove(file("server.pem"));
  make("client stranger");  // which makes a new authority and a new server certificate too
  ASSERT_NE(pem("server.pem"), before);
  std::ofstream(file("holders.new")) << R"({"certificates":
    [{"common_name": "stranger", "tenant": "ward", "roles": ["viewer"]}]})";
  std::filesystem::rename(file("holders.new"), file("holders.json"));
  Answer answer = list(client("client-stranger"));
  for (int i = 0; i < 100 && !answer.status.ok(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    answer = list(client("client-stranger"));
  }
  EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
  EXPECT_EQ(list(client("client-wall", "", "secrets/old-ca.pem")).code(), StatusCode::UNAVAILABLE)
      << "the old certificate is not shown any more";
}

TEST_F(TlsTest, TheCommandLineSaysWhoItIsByFiles) {
  start_with_client_certificates({"--tls-client-certificate-optional"});
  std::ofstream(file("token")) << token(claims("ward", "planner")) << "\n";
  const std::string server = " --server " + address();
  const auto lipofill = [&](const std::string& arguments) { return run_shell("lipofill " + arguments + server); };
  const CommandResult unknown = lipofill("patient list --tls-ca " + file("ca.pem"));
  EXPECT_EQ(unknown.exit_code, 4);
  EXPECT_THAT(unknown.errors, HasSubstr("does not know who calls"));
  EXPECT_THAT(unknown.errors, HasSubstr("--token-file or LIPOFILL_TOKEN_FILE"));
  const std::string with_token = " --tls-ca " + file("ca.pem") + " --token-file " + file("token");
  const CommandResult created = lipofill("patient create --id ward-a" + with_token);
  EXPECT_EQ(created.exit_code, 0) << created.errors;
  const CommandResult listed = lipofill("patient list --tls-ca " + file("ca.pem") + " --tls-cert " +
                                        file("client-wall.pem") + " --tls-key " + file("client-wall.key"));
  EXPECT_EQ(listed.exit_code, 0) << listed.errors;
  EXPECT_THAT(listed.output, HasSubstr("ward-a"));
  const CommandResult denied = lipofill("patient delete patients/ward-a" + with_token);
  EXPECT_EQ(denied.exit_code, 4);
  EXPECT_THAT(denied.errors, HasSubstr("needs the role admin"));
  const CommandResult by_environment =
      run_shell("env LIPOFILL_TLS_CA=" + file("ca.pem") + " LIPOFILL_TOKEN_FILE=" + file("token") +
                " lipofill patient list" + server);
  EXPECT_EQ(by_environment.exit_code, 0) << by_environment.errors;
  EXPECT_THAT(daemon_->log(), Not(HasSubstr(token(claims("ward", "planner")).substr(0, 20))));
}

}  // namespace
}  // namespace lipofill::testing
