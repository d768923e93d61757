// Two tenants on one daemon: what is the other's is, on every method there is, exactly as what is
// not there.

#include <google/protobuf/util/message_differencer.h>

#include "absl/strings/str_replace.h"
#include "google/rpc/status.pb.h"
#include "lipofill/v1/plan_service.pb.h"
#include "tests/integration/security/reflected_api.h"
#include "tests/integration/security/secure_fixture.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;

/// A method and a request that names something; for some methods there are several.
struct Row {
  std::string method;
  std::string request;
};

std::vector<Row> rows_about(const Possessions& theirs) {
  const auto named = [](const std::string& name) { return R"({"name":")" + name + "\"}"; };
  const auto below = [](const std::string& name, const std::string& more = "") {
    return R"({"parent":")" + name + "\"" + more + "}";
  };
  const std::string sha(64, 'a');
  return {
      {"FrameService/Watch", R"({"simulation":")" + theirs.simulation + "\"}"},
      {"FrameService/Watch", R"({"simulation":")" + theirs.simulation + R"(","intervalMs":-1})"},
      {"FrameService/AcknowledgeFrame", R"({"simulation":")" + theirs.simulation + R"(","viewer":"v"})"},
      {"OperationService/GetOperation", named(theirs.operation)},
      {"OperationService/WaitOperation", named(theirs.operation)},
      {"OperationService/CancelOperation", named(theirs.operation)},
      {"PatientService/GetPatient", named(theirs.patient)},
      {"PatientService/UpdatePatient", R"({"patient":{"name":")" + theirs.patient + R"(","displayName":"x"}})"},
      {"PatientService/UpdatePatient", R"({"patient":{"name":")" + theirs.patient + R"(","etag":"old"}})"},
      {"PatientService/DeletePatient", named(theirs.patient)},
      {"PatientService/DeletePatient", R"({"name":")" + theirs.patient + R"(","force":true})"},
      {"PatientService/CreateScan",
       below(theirs.patient, R"(,"format":"OBJ","sizeBytes":"9","sha256":")" + sha + "\"")},
      {"PatientService/CreateScan", below(theirs.patient)},
      {"PatientService/UploadScan", R"({"name":")" + theirs.scan + R"(","data":"AAAA"})"},
      {"PatientService/GetScan", named(theirs.scan)},
      {"PatientService/ListScans", below(theirs.patient)},
      {"PatientService/ListScans", below(theirs.patient, R"(,"pageSize":-1)")},
      {"PatientService/DeleteScan", named(theirs.scan)},
      {"PatientService/BuildModel", below(theirs.patient)},
      {"PatientService/BuildModel", below(theirs.patient, R"(,"validateOnly":true,"spec":{})")},
      {"PatientService/GetModel", named(theirs.model)},
      {"PatientService/ListModels", below(theirs.patient)},
      {"PatientService/DeleteModel", named(theirs.model)},
      {"PatientService/DownloadModelMesh", named(theirs.model)},
      {"PatientService/DownloadScanMesh", named(theirs.scan)},
      {"PlanService/CreatePlan", below(theirs.patient)},
      {"PlanService/CreatePlan", below("patients/-", R"(,"plan":{"scan":")" + theirs.scan + "\"}")},
      {"PlanService/GetPlan", named(theirs.plan)},
      {"PlanService/ListPlans", below(theirs.patient)},
      {"PlanService/UpdatePlan", R"({"plan":{"name":")" + theirs.plan + R"(","title":"x"}})"},
      {"PlanService/UpdatePlan", R"({"plan":{"name":")" + theirs.plan + R"(","etag":"old"}})"},
      {"PlanService/DeletePlan", named(theirs.plan)},
      {"PlanService/AddPlanRun", R"({"name":")" + theirs.plan + R"(","simulation":")" + theirs.simulation + "\"}"},
      {"PlanService/ListPlanRevisions", below(theirs.plan)},
      {"PlanService/GetPlanRevision", R"({"name":")" + theirs.plan + R"(","revision":"1"})"},
      {"PlanningService/MakeTarget", below(theirs.patient, R"(,"spec":{"scan":")" + theirs.scan + "\"}")},
      {"PlanningService/MeasureDeficit", R"({"scan":")" + theirs.scan + R"(","targetScan":")" + theirs.scan + "\"}"},
      {"PlanningService/ProposePlan", below(theirs.patient, R"(,"spec":{"targetScan":")" + theirs.scan + "\"}")},
      {"PlanningService/ProposePlan", R"({"spec":{"plan":{"model":")" + theirs.model + "\"}}}"},
      {"PlanningService/PlanDelivery", R"({"plan":{"model":")" + theirs.model + "\"}}"},
      {"PlanningService/ArrangeFace", R"({"parts":[{"name":"a","plan":{"model":")" + theirs.model + "\"}}]}"},
      {"ForecastService/MakeForecast", below(theirs.patient, R"(,"spec":{})")},
      {"ForecastService/MakeForecast", R"({"spec":{"plan":{"model":")" + theirs.model + "\"}}}"},
      {"SimulationService/CreateSimulation", R"({"spec":{"model":")" + theirs.model + "\"}}"},
      {"SimulationService/CheckPlan", R"({"spec":{"model":")" + theirs.model + "\"}}"},
      {"SimulationService/FindShape", R"({"spec":{"model":")" + theirs.model + "\"}}"},
      {"SimulationService/FindShape", R"({"simulation":")" + theirs.simulation + "\"}"},
      {"SimulationService/GetSimulation", named(theirs.simulation)},
      {"SimulationService/GetSimulation", R"({"name":")" + theirs.simulation + R"(","readMask":"nose"})"},
      {"SimulationService/StartSimulation", named(theirs.simulation)},
      {"SimulationService/PauseSimulation", named(theirs.simulation)},
      {"SimulationService/ResumeSimulation", named(theirs.simulation)},
      {"SimulationService/StopSimulation", named(theirs.simulation)},
      {"SimulationService/DeleteSimulation", named(theirs.simulation)},
      {"SimulationService/Inject", R"({"name":")" + theirs.simulation + R"(","injection":{"zone":"middle"}})"},
      {"SimulationService/CreateCheckpoint", below(theirs.simulation, R"(,"checkpointId":"c")")},
      {"SimulationService/GetCheckpoint", named(theirs.checkpoint)},
      {"SimulationService/ListCheckpoints", below(theirs.simulation)},
      {"SimulationService/DeleteCheckpoint", named(theirs.checkpoint)},
      {"SimulationService/RestoreSimulation", R"({"checkpoint":")" + theirs.checkpoint + "\"}"},
      {"SimulationService/RestoreSimulation", R"({"checkpoint":")" + theirs.checkpoint + R"(","asNew":true})"},
      {"SimulationService/GetSeries", named(theirs.simulation)},
      {"SimulationService/EvaluateSimulation",
       R"({"name":")" + theirs.simulation + R"(","targetScan":")" + theirs.scan + "\"}"},
      {"SimulationService/ExportTissueDeck", named(theirs.simulation)},
  };
}

/// Those that name nothing: they are looked at one by one.
const std::set<std::string> kNamesNothing = {
    full_name("ForecastService/EstimateRetention"), full_name("OperationService/ListOperations"),
    full_name("PatientService/CreatePatient"), full_name("PatientService/ListPatients"),
    full_name("SimulationService/ListSimulations")};

class TenantsTest : public SecureTest {
 protected:
  TenantsTest() : wards_(caller("ward", "admin"), "ward") {}

  /// The same with names of the same length that nothing has.
  std::string absent(const std::string& text) const {
    return absl::StrReplaceAll(text,
                               {{"ward-a", "ward-q"}, {"ward-x", "ward-y"}, {wards_.operation, absent_operation()}});
  }
  std::string absent_operation() const { return "operations/o" + std::string(wards_.operation.size() - 12, '0'); }

  /// Whoever it is must get the same answer about the ward's things as about nothing.
  void expect_that_nothing_is_there(const Caller& someone) {
    for (const Row& row : rows_about(wards_)) {
      const Answer theirs = someone.call_json(row.method, row.request);
      const Answer nothing = someone.call_json(row.method, absent(row.request));
      const std::string what = row.method + " " + row.request;
      EXPECT_EQ(theirs.code(), StatusCode::NOT_FOUND) << what << ": " << theirs.status.error_message();
      EXPECT_EQ(absent(theirs.status.error_message()), nothing.status.error_message()) << what;
      EXPECT_EQ(theirs.code(), nothing.code()) << what;
      EXPECT_EQ(theirs.reason(), nothing.reason()) << what;
      EXPECT_TRUE(theirs.messages.empty()) << what;
      google::rpc::Status ours, other;
      EXPECT_TRUE(ours.ParseFromString(theirs.status.error_details()));
      EXPECT_TRUE(other.ParseFromString(nothing.status.error_details()));
      ours.set_message(absent(ours.message()));
      EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(ours, other)) << what;
    }
  }
  template <typename Response>
  Response list(const Caller& someone, const std::string& method) {
    const Answer answer = someone.call_json(method, "{}");
    EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
    Response response;
    EXPECT_TRUE(answer.messages.size() == 1 && response.ParseFromString(answer.messages[0]));
    return response;
  }
  /// The number of plans of all patients that somebody is shown.
  int shown_plans(const Caller& someone) {
    const Answer answer = someone.call_json("PlanService/ListPlans", R"({"parent":"patients/-"})");
    EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
    v1::ListPlansResponse response;
    EXPECT_TRUE(answer.messages.size() == 1 && response.ParseFromString(answer.messages[0]));
    return response.plans_size();
  }
  /// Numbers of patients, simulations and operations that somebody is shown.
  std::vector<int> shown(const Caller& someone) {
    return {list<v1::ListPatientsResponse>(someone, "PatientService/ListPatients").patients_size(),
            list<v1::ListSimulationsResponse>(someone, "SimulationService/ListSimulations").simulations_size(),
            list<v1::ListOperationsResponse>(someone, "OperationService/ListOperations").operations_size()};
  }

  const Possessions wards_;
};

TEST_F(TenantsTest, EveryMethodHasARow) {
  std::set<std::string> tabled = kNamesNothing;
  for (const Row& row : rows_about(wards_)) tabled.insert(full_name(row.method));
  for (const std::string& method : reflect_methods(bearer(""))) {
    EXPECT_EQ(tabled.count(method), 1u) << method << " is new: give it a row in this test";
  }
}

TEST_F(TenantsTest, WhatIsAnothersIsAsWhatIsNotThere) {
  const Caller clinic = caller("clinic", "admin");
  expect_that_nothing_is_there(clinic);
  expect_that_nothing_is_there(caller("local", "admin"));
  expect_that_nothing_is_there(caller("ward", "admin", {"ward-b"}));
  EXPECT_THAT(shown(clinic), ::testing::ElementsAre(0, 0, 0));
  EXPECT_THAT(shown(caller("ward", "viewer", {"ward-b"})), ::testing::ElementsAre(0, 0, 0));
  EXPECT_THAT(shown(caller("ward", "viewer", {"ward-a", "ward-b"})), ::testing::ElementsAre(1, 1, 1));
  EXPECT_THAT(shown(caller("ward", "viewer")), ::testing::ElementsAre(1, 1, 1));
  EXPECT_EQ(shown_plans(clinic), 0);
  EXPECT_EQ(shown_plans(caller("ward", "viewer", {"ward-b"})), 0);
  EXPECT_EQ(shown_plans(caller("ward", "viewer", {"ward-a"})), 1);
  EXPECT_EQ(shown_plans(caller("ward", "viewer")), 1);
  const Caller viewer = caller("ward", "viewer", {"ward-a"});
  EXPECT_TRUE(viewer.call_json("PatientService/GetModel", R"({"name":")" + wards_.model + "\"}").status.ok());
  EXPECT_TRUE(
      viewer.call_json("SimulationService/GetCheckpoint", R"({"name":")" + wards_.checkpoint + "\"}").status.ok())
      << "nothing of what others asked for was done";
}

TEST_F(TenantsTest, StayApartAfterTheDaemonHasEnded) {
  EXPECT_EQ(daemon_->terminate(), 0);
  start({});
  EXPECT_THAT(shown(caller("clinic", "admin")), ::testing::ElementsAre(0, 0, 0));
  EXPECT_THAT(shown(caller("ward", "viewer")), ::testing::ElementsAre(1, 1, 0)) << "operations do not outlive it";
  const Answer watched =
      caller("clinic", "viewer").call_json("FrameService/Watch", R"({"simulation":"simulations/ward-x"})");
  EXPECT_EQ(watched.code(), StatusCode::NOT_FOUND);
}

TEST_F(TenantsTest, IdsAndRequestIdsAreATenantsOwn) {
  const Caller clinic = caller("clinic", "planner");
  const Answer taken = clinic.call_json("PatientService/CreatePatient", R"({"patientId":"ward-a"})");
  const Answer free = clinic.call_json("PatientService/CreatePatient", R"({"patientId":"ward-q"})");
  EXPECT_EQ(taken.code(), StatusCode::INVALID_ARGUMENT) << "not ALREADY_EXISTS, which would tell";
  EXPECT_EQ(absent(taken.status.error_message()), free.status.error_message());
  EXPECT_THAT(taken.status.error_message(), ::testing::HasSubstr("must begin with \"clinic-\""));

  const char* const request = R"({"requestId":"r1"})";
  const Answer first = clinic.call_json("PatientService/CreatePatient", request);
  const Answer again = clinic.call_json("PatientService/CreatePatient", request);
  const Answer others = caller("ward", "planner").call_json("PatientService/CreatePatient", request);
  ASSERT_TRUE(first.status.ok() && again.status.ok() && others.status.ok());
  EXPECT_EQ(first.messages, again.messages);
  EXPECT_NE(first.messages, others.messages) << "the same request id of another tenant is another request";

  const Caller limited = caller("ward", "planner", {"ward-n"});
  const Answer refused = limited.call_json("PatientService/CreatePatient", R"({"patientId":"ward-m"})");
  EXPECT_EQ(refused.code(), StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(refused.reason(), "PATIENT_NOT_YOURS");
  EXPECT_TRUE(limited.call_json("PatientService/CreatePatient", R"({"patientId":"ward-n"})").status.ok());
}

}  // namespace
}  // namespace lipofill::testing
