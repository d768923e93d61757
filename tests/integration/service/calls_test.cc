// What every call passes: ids in the metadata, one line in the log, nothing of patients in it.

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

constexpr char kTraceParent[] = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";

class CallsTest : public ServiceTest {
 protected:
  CallsTest() : ServiceTest({"--log-format", "json"}) {}

  /// Lines of the log about calls of this method.
  std::vector<nlohmann::json> calls_of(const std::string& method) {
    std::vector<nlohmann::json> lines;
    std::istringstream log(daemon_->log());
    for (std::string line; std::getline(log, line);) {
      const auto object = nlohmann::json::parse(line);
      if (object["message"] == "call" && object["method"] == method) lines.push_back(object);
    }
    return lines;
  }
  static std::string request_id_of(const Context& context) {
    const auto found = context.GetServerInitialMetadata().find("x-request-id");
    if (found == context.GetServerInitialMetadata().end()) return "";
    return std::string(found->second.data(), found->second.size());
  }
};

TEST_F(CallsTest, AnswerWithTheRequestIdOfTheClientAndLogIt) {
  Context context;
  context.AddMetadata("x-request-id", "order-66");
  context.AddMetadata("traceparent", kTraceParent);
  v1::Patient patient;
  v1::CreatePatientRequest request;
  request.set_patient_id("anna");
  ASSERT_TRUE(patients_->CreatePatient(&context, request, &patient).ok());
  EXPECT_EQ(request_id_of(context), "order-66");
  const auto lines = calls_of("/lipofill.v1.PatientService/CreatePatient");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["level"], "info");
  EXPECT_EQ(lines[0]["code"], "OK");
  EXPECT_EQ(lines[0]["request_id"], "order-66");
  EXPECT_EQ(lines[0]["trace_id"], "4bf92f3577b34da6a3ce929d0e0e4736");
  EXPECT_EQ(lines[0]["parent_id"], "00f067aa0ba902b7");
  EXPECT_GE(lines[0]["duration_ms"].get<double>(), 0.0);
  EXPECT_THAT(daemon_->log(), HasSubstr("\"message\":\"patients/anna created\",\"request_id\":\"order-66\""));
}

TEST_F(CallsTest, AreGivenAnIdAndLoggedWithTheirCodeWhenTheyFail) {
  Context context;
  v1::GetPatientRequest request;
  request.set_name("patients/nobody");
  v1::Patient patient;
  EXPECT_EQ(patients_->GetPatient(&context, request, &patient).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(request_id_of(context), MatchesRegex("r[0-9a-f]{16}"));
  const auto lines = calls_of("/lipofill.v1.PatientService/GetPatient");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0]["code"], "NOT_FOUND");
  EXPECT_EQ(lines[0]["request_id"], request_id_of(context));
  EXPECT_FALSE(lines[0].contains("trace_id"));
}

TEST_F(CallsTest, AreLoggedOnceAlsoWhenTheyStream) {
  create_patient();
  v1::Scan scan;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(), scan).ok());
  EXPECT_EQ(calls_of("/lipofill.v1.PatientService/UploadScan").size(), 1u);
  const v1::Model model = build_square();
  v1::Simulation simulation;
  ASSERT_TRUE(create_simulation(square_plan(model.name(), 0.1), "x", true, simulation).ok());
  v1::WatchRequest request;
  request.set_simulation("simulations/x");
  Watcher watcher(*channel_, request);
  watcher.drain();
  EXPECT_TRUE(watcher.finish().ok());
  const auto watches = calls_of("/lipofill.v1.FrameService/Watch");
  ASSERT_EQ(watches.size(), 1u);
  EXPECT_EQ(watches[0]["code"], "OK");
  EXPECT_EQ(calls_of("/lipofill.v1.SimulationService/CreateSimulation").size(), 1u);
}

TEST_F(CallsTest, AreLoggedWhenTheirRequestCannotBeRead) {
  EXPECT_FALSE(call_raw("/lipofill.v1.PatientService/GetPatient", "\x0a\xff no message").ok());
  EXPECT_EQ(calls_of("/lipofill.v1.PatientService/GetPatient").size(), 1u);
  EXPECT_EQ(call_raw("/lipofill.v1.PatientService/NoSuchMethod", "").error_code(), grpc::StatusCode::UNIMPLEMENTED);
  EXPECT_EQ(calls_of("unknown").size(), 1u);
  EXPECT_THAT(daemon_->log(), Not(HasSubstr("NoSuchMethod")));
  EXPECT_TRUE(is_serving()) << daemon_->log();
}

TEST_F(CallsTest, LeaveNothingOfPatientsInTheLog) {
  v1::CreatePatientRequest request;
  request.set_patient_id("p1");
  request.set_display_name("mustermann");
  (*request.mutable_labels())["surname"] = "musterfrau";
  v1::Patient patient;
  EXPECT_TRUE(call(*patients_, &v1::PatientService::Stub::CreatePatient, request, patient).ok());
  request.set_display_name("Erika Mustermann");
  EXPECT_FALSE(call(*patients_, &v1::PatientService::Stub::CreatePatient, request, patient).ok());
  EXPECT_EQ(calls_of("/lipofill.v1.PatientService/CreatePatient").size(), 2u);
  EXPECT_THAT(daemon_->log(), Not(AnyOf(HasSubstr("muster"), HasSubstr("Muster"))));
}

}  // namespace
}  // namespace lipofill::testing
