// The whole API, as the daemon itself tells it by reflection, called by everybody there is. A
// method that nobody has thought of here, or that has no rule in the daemon, fails.

#include "tests/integration/security/reflected_api.h"
#include "tests/integration/security/secure_fixture.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;

/// The least role that may call each method, as core/doc/security.md has it.
const std::map<std::string, std::string>& expected_roles() {
  static const std::map<std::string, std::string> roles = [] {
    std::map<std::string, std::string> all;
    const auto add = [&all](const char* role, std::initializer_list<const char*> methods) {
      for (const char* method : methods) all[full_name(method)] = role;
    };
    add("viewer", {"ForecastService/EstimateRetention",
                   "FrameService/AcknowledgeFrame",
                   "FrameService/Watch",
                   "OperationService/GetOperation",
                   "OperationService/ListOperations",
                   "OperationService/WaitOperation",
                   "PatientService/DownloadModelMesh",
                   "PatientService/DownloadScanMesh",
                   "PatientService/GetModel",
                   "PatientService/GetPatient",
                   "PatientService/GetScan",
                   "PatientService/ListModels",
                   "PatientService/ListPatients",
                   "PatientService/ListScans",
                   "PlanService/GetPlan",
                   "PlanService/GetPlanRevision",
                   "PlanService/ListPlanRevisions",
                   "PlanService/ListPlans",
                   "PlanningService/ArrangeFace",
                   "PlanningService/MeasureDeficit",
                   "PlanningService/PlanDelivery",
                   "SimulationService/CheckPlan",
                   "SimulationService/EvaluateSimulation",
                   "SimulationService/ExportTissueDeck",
                   "SimulationService/FindShape",
                   "SimulationService/GetCheckpoint",
                   "SimulationService/GetSeries",
                   "SimulationService/GetSimulation",
                   "SimulationService/ListCheckpoints",
                   "SimulationService/ListSimulations"});
    add("planner", {"ForecastService/MakeForecast",
                    "OperationService/CancelOperation",
                    "PatientService/BuildModel",
                    "PatientService/CreatePatient",
                    "PatientService/CreateScan",
                    "PatientService/DeleteModel",
                    "PatientService/DeleteScan",
                    "PatientService/UpdatePatient",
                    "PatientService/UploadScan",
                    "PlanService/AddPlanRun",
                    "PlanService/CreatePlan",
                    "PlanService/DeletePlan",
                    "PlanService/UpdatePlan",
                    "PlanningService/MakeTarget",
                    "PlanningService/ProposePlan",
                    "SimulationService/CreateCheckpoint",
                    "SimulationService/CreateSimulation",
                    "SimulationService/DeleteCheckpoint",
                    "SimulationService/DeleteSimulation",
                    "SimulationService/Inject",
                    "SimulationService/PauseSimulation",
                    "SimulationService/RestoreSimulation",
                    "SimulationService/ResumeSimulation",
                    "SimulationService/StartSimulation",
                    "SimulationService/StopSimulation"});
    add("admin", {"PatientService/DeletePatient"});
    return all;
  }();
  return roles;
}

int rank_of(const std::string& role) {
  const std::vector<std::string> roles = {"none", "viewer", "planner", "admin"};
  return static_cast<int>(std::find(roles.begin(), roles.end(), role) - roles.begin());
}

class RolesTest : public SecureTest {
 protected:
  RolesTest() : methods_(reflect_methods(bearer(""))) {}
  const std::set<std::string> methods_;
};

TEST_F(RolesTest, EveryMethodIsThoughtOf) {
  EXPECT_GE(methods_.size(), expected_roles().size()) << "reflection is open to everybody";
  for (const std::string& method : methods_) {
    EXPECT_EQ(expected_roles().count(method), 1u)
        << method
        << " is new: say in this test, in core/doc/security.md and in server/entry/method_rules.cc who may call it";
  }
}

TEST_F(RolesTest, NobodyGetsAnywhereWithoutSayingWhoTheyAre) {
  SigningKey other = SigningKey::p256();
  for (const std::string& method : methods_) {
    for (const std::string& request : {std::string(), std::string("\x0a\xff rubbish")}) {
      const Answer answer = bearer("").call_bytes(method, request);
      // What gRPC cannot read it refuses by itself, before there is anybody to ask.
      if (!request.empty() && answer.code() == StatusCode::UNIMPLEMENTED) continue;
      EXPECT_EQ(answer.code(), StatusCode::UNAUTHENTICATED) << method << ": " << answer.status.error_message();
      EXPECT_EQ(answer.reason(), "NO_CREDENTIALS") << method;
      EXPECT_TRUE(answer.messages.empty()) << method;
    }
    const Answer forged = bearer(other.token(claims("ward", "admin"))).call_bytes(method, "");
    EXPECT_EQ(forged.code(), StatusCode::UNAUTHENTICATED) << method;
    EXPECT_EQ(forged.reason(), "TOKEN_SIGNATURE") << method;
  }
}

TEST_F(RolesTest, EachRoleMayWhatIsItsOwn) {
  for (const char* role : {"none", "viewer", "planner", "admin"}) {
    const Caller someone = caller("ward", role);
    for (const std::string& method : methods_) {
      const Answer answer = someone.call_bytes(method, "");
      const std::string what = std::string(role) + " " + method + ": " + answer.status.error_message();
      if (rank_of(role) < rank_of(expected_roles().at(method))) {
        EXPECT_EQ(answer.code(), StatusCode::PERMISSION_DENIED) << what;
        EXPECT_EQ(answer.reason(), "ROLE_TOO_LOW") << what;
        EXPECT_TRUE(answer.messages.empty()) << what;
      } else {
        EXPECT_NE(answer.code(), StatusCode::PERMISSION_DENIED) << what;
        EXPECT_NE(answer.code(), StatusCode::UNAUTHENTICATED) << what;
      }
    }
  }
  EXPECT_TRUE(caller("ward", "admin").call_json("PatientService/ListPatients", "{}").status.ok());
}

TEST_F(RolesTest, HealthIsOpenAndReflectionCanBeClosed) {
  EXPECT_TRUE(bearer("").call_bytes("/grpc.health.v1.Health/Check", "").status.ok());
  EXPECT_EQ(bearer("").call_bytes("/no.such.Service/Method", "").code(), StatusCode::UNIMPLEMENTED);
  start({"--reflection=false"});
  const Answer answer =
      bearer("").call_bytes("/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", std::string("\x3a\0", 2));
  EXPECT_EQ(answer.code(), StatusCode::UNIMPLEMENTED);
  EXPECT_TRUE(bearer("").call_bytes("/grpc.health.v1.Health/Check", "").status.ok());
}

}  // namespace
}  // namespace lipofill::testing
