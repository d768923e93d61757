// The audit log of the real daemon: what is in it, what is not, and that nothing happens without
// it.

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/integration/security/secure_fixture.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

class AuditTest : public SecureTest {
 protected:
  AuditTest() : AuditTest(std::vector<std::string>{}) {}
  explicit AuditTest(const std::vector<std::string>& arguments) : SecureTest(arguments) {}

  /// Lines about a method, "PatientService/GetPatient". A call's last line may come a moment after
  /// its answer.
  std::vector<Json> lines_of(const std::string& method) {
    std::vector<Json> lines;
    std::istringstream file(read_whole_file(audit_file()));
    for (std::string line; std::getline(file, line);) {
      lines.push_back(Json::parse(line));
      if (lines.back()["method"] != full_name(method)) lines.pop_back();
    }
    return lines;
  }
  static std::string outcomes(const std::vector<Json>& lines) {
    std::string all;
    for (const Json& line : lines) all += line["outcome"].get<std::string>() + " ";
    return all;
  }
};

TEST_F(AuditTest, SaysWhoDidWhatToWhomAndHowItEnded) {
  const Caller planner = caller("ward", "planner");
  ASSERT_TRUE(planner.call_json("PatientService/CreatePatient", R"({"patientId":"ward-a"})").status.ok());
  ASSERT_TRUE(planner.call_json("PatientService/GetPatient", R"({"name":"patients/ward-a"})").status.ok());
  caller("clinic", "admin").call_json("PatientService/DeletePatient", R"({"name":"patients/ward-a"})");
  caller("ward", "viewer").call_json("PatientService/DeletePatient", R"({"name":"patients/ward-a"})");
  bearer("").call_json("PatientService/ListPatients", "{}");
  planner.call_json("FrameService/AcknowledgeFrame", R"({"simulation":"simulations/none"})");
  EXPECT_EQ(daemon_->terminate(), 0);

  const auto created = lines_of("PatientService/CreatePatient");
  ASSERT_EQ(outcomes(created), "BEGUN OK ");
  EXPECT_EQ(created[1]["subject"], "planner-of-ward");
  EXPECT_EQ(created[1]["tenant"], "ward");
  EXPECT_EQ(created[1]["role"], "planner");
  EXPECT_EQ(created[1]["made"], "patients/ward-a");
  EXPECT_EQ(created[0]["request_id"], created[1]["request_id"]);
  EXPECT_THAT(daemon_->log(), HasSubstr(created[1]["request_id"].get<std::string>()));
  const auto looked = lines_of("PatientService/GetPatient");
  ASSERT_EQ(outcomes(looked), "OK ");
  EXPECT_EQ(looked[0]["resources"], Json({"patients/ward-a"}));
  const auto refused = lines_of("PatientService/DeletePatient");
  ASSERT_EQ(outcomes(refused), "NOT_FOUND PERMISSION_DENIED ") << "neither began";
  EXPECT_EQ(refused[0]["tenant"], "clinic");
  EXPECT_EQ(refused[0]["resources"], Json({"patients/ward-a"})) << "what they tried";
  EXPECT_EQ(refused[1]["subject"], "viewer-of-ward");
  EXPECT_EQ(refused[1]["resources"], Json({"patients/ward-a"}));
  const auto stranger = lines_of("PatientService/ListPatients");
  ASSERT_EQ(outcomes(stranger), "UNAUTHENTICATED ");
  EXPECT_EQ(stranger[0]["subject"], "");
  EXPECT_EQ(outcomes(lines_of("FrameService/AcknowledgeFrame")), "") << "sixty a second would drown the rest";
}

TEST_F(AuditTest, HasNeitherTokensNorWhatIsSaidOfPatientsAndNorDoesTheLog) {
  const std::string secret = token(claims("ward", "planner"));
  const Caller planner = bearer(secret);
  const char* const request = R"({"patientId":"ward-a","displayName":"mustermann","labels":{"surname":"musterfrau"}})";
  ASSERT_TRUE(planner.call_json("PatientService/CreatePatient", request).status.ok());
  planner.call_json("PatientService/GetPatient", R"({"name":"patients/Erika Mustermann"})");
  planner.call_json("PatientService/GetPatient", R"({"name":"patients/ward-a/Mustermann"})");
  bearer(secret + "x").call_json("PatientService/ListPatients", "{}");
  EXPECT_EQ(daemon_->terminate(), 0);
  for (const std::string& text : {read_whole_file(audit_file()), daemon_->log()}) {
    EXPECT_THAT(text, HasSubstr("ward-a"));
    EXPECT_THAT(text, Not(HasSubstr("muster")));
    EXPECT_THAT(text, Not(HasSubstr("Muster")));
    EXPECT_THAT(text, Not(HasSubstr(secret.substr(0, 30))));
    EXPECT_THAT(text, Not(HasSubstr(secret.substr(secret.size() - 30))));
  }
}

TEST_F(AuditTest, IsVerifiedFromTheCommandLine) {
  const Caller planner = caller("ward", "planner");
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(planner.call_json("PatientService/CreatePatient", "{}").status.ok());
  daemon_->kill_hard();
  start({});
  ASSERT_TRUE(caller("ward", "viewer").call_json("PatientService/ListPatients", "{}").status.ok());
  EXPECT_EQ(daemon_->terminate(), 0);
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--verify-audit", audit_file()}, output), 0) << output;
  EXPECT_THAT(output, HasSubstr("11 lines, each carries on from the one before"));
  const size_t at = output.find("the last is line 11, hash ");
  ASSERT_NE(at, std::string::npos) << output;
  EXPECT_THAT(daemon_->log(), HasSubstr("ends with line 11, hash " + output.substr(at + 26, 64)));
  std::string text = read_whole_file(audit_file());
  text.erase(text.find('\n') + 1, text.find('\n', text.find('\n') + 1) - text.find('\n'));
  std::ofstream(audit_file()) << text;
  EXPECT_EQ(run_daemon_to_end({"--verify-audit", audit_file()}, output), 1);
  EXPECT_THAT(output, HasSubstr("line 2: does not carry on from the line before"));
}

TEST_F(AuditTest, StrangersDoNotFillIt) {
  for (int i = 0; i < 300; ++i) bearer("").call_json("PatientService/ListPatients", "{}");
  EXPECT_EQ(daemon_->terminate(), 0);
  EXPECT_LE(lines_of("PatientService/ListPatients").size(), 200u) << "a hundred a minute";
  EXPECT_GE(lines_of("PatientService/ListPatients").size(), 100u);
}

class FullAuditTest : public AuditTest {
 protected:
  FullAuditTest() : AuditTest({"--audit-file", "/dev/full"}) {}
};

TEST_F(FullAuditTest, NothingIsChangedWithoutALine) {
  const Caller planner = caller("ward", "planner");
  const Answer refused = planner.call_json("PatientService/CreatePatient", "{}");
  EXPECT_EQ(refused.code(), StatusCode::UNAVAILABLE) << refused.status.error_message();
  EXPECT_EQ(refused.reason(), "AUDIT_UNAVAILABLE");
  const Answer listed = planner.call_json("PatientService/ListPatients", "{}");
  EXPECT_TRUE(listed.status.ok()) << "who only looks is not kept from it";
  EXPECT_EQ(listed.messages, std::vector<std::string>{""}) << "there is no patient";
  EXPECT_THAT(daemon_->log(), HasSubstr("the audit log cannot be written"));
}

TEST_F(AuditTest, ALogWhoseEndIsCutOffIsNoticedAtTheNextStart) {
  const Caller planner = caller("ward", "planner");
  for (const char* id : {"ward-a", "ward-b", "ward-c"}) {
    const std::string request = R"({"patientId":")" + std::string(id) + "\"}";
    ASSERT_TRUE(planner.call_json("PatientService/CreatePatient", request).status.ok());
  }
  daemon_->kill_hard();
  const std::string whole = read_whole_file(audit_file());
  std::string output;
  EXPECT_EQ(run_daemon_to_end({"--verify-audit", audit_file()}, output), 0) << output;
  EXPECT_THAT(output, HasSubstr("which is there"));
  const size_t cut = whole.rfind("BEGUN");
  std::ofstream(audit_file()) << whole.substr(0, whole.rfind('\n', cut) + 1);
  EXPECT_EQ(run_daemon_to_end({"--verify-audit", audit_file()}, output), 1);
  EXPECT_THAT(output, HasSubstr("the end was cut off"));
  std::vector<std::string> arguments = arguments_;
  arguments.insert(arguments.end(), {"--data", directory_.file("data"), "--listen", "127.0.0.1:0"});
  EXPECT_EQ(run_daemon_to_end(arguments, output), 1);
  EXPECT_THAT(output, HasSubstr("its end was cut off"));
  std::ofstream(audit_file()) << whole;
  start({});
  EXPECT_TRUE(caller("ward", "planner").call_json("PatientService/ListPatients", "{}").status.ok());
}

}  // namespace
}  // namespace lipofill::testing
