// What every call of the API answers to a request that is wrong: a table, and a check that no call
// is missing in it.

#include <google/protobuf/util/json_util.h>

#include <set>

#include "lipofill/v1/forecast_service.pb.h"
#include "lipofill/v1/plan_service.pb.h"
#include "lipofill/v1/planning_service.pb.h"
#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;
using Fields = std::vector<std::string>;

/// A request in JSON and what it is answered: the code, the reason of the ErrorInfo, and the fields
/// of the BadRequest.
struct Row {
  std::string method;
  std::string request;
  StatusCode code;
  std::string reason;
  Fields fields;
};

constexpr StatusCode kInvalid = StatusCode::INVALID_ARGUMENT;

Row invalid(std::string method, std::string request, Fields fields) {
  return {std::move(method), std::move(request), kInvalid, "FIELD_VIOLATION", std::move(fields)};
}
Row absent(std::string method, std::string request) {
  return {std::move(method), std::move(request), StatusCode::NOT_FOUND, "NOT_FOUND", {}};
}
Row early(std::string method, std::string request) {
  return {std::move(method), std::move(request), StatusCode::FAILED_PRECONDITION, "FAILED_PRECONDITION", {}};
}

/// patients/anna has a scan that is not complete and a model; simulations/x is READY, simulations/y
/// has ended.
std::vector<Row> patient_rows() {
  const std::string patients = "PatientService/";
  return {
      invalid(patients + "CreatePatient", R"({"patientId":"A B","displayName":"Anna Smith"})",
              {"display_name", "patient_id"}),
      invalid(patients + "CreatePatient", R"({"labels":{"Born":"1970"},"validateOnly":true})", {"labels"}),
      {patients + "CreatePatient", R"({"patientId":"anna"})", StatusCode::ALREADY_EXISTS, "ALREADY_EXISTS", {}},
      {patients + "CreatePatient",
       R"({"patientId":"anna","validateOnly":true})",
       StatusCode::ALREADY_EXISTS,
       "ALREADY_EXISTS",
       {}},
      invalid(patients + "GetPatient", R"({"name":"anna"})", {"name"}),
      absent(patients + "GetPatient", R"({"name":"patients/berta"})"),
      invalid(patients + "ListPatients", R"({"pageSize":-1})", {"page_size"}),
      invalid(patients + "ListPatients", R"({"pageToken":"made-up"})", {"page_token"}),
      invalid(patients + "UpdatePatient", R"({"patient":{"name":"patients/anna"},"updateMask":"createTime"})",
              {"update_mask"}),
      invalid(patients + "UpdatePatient",
              R"({"patient":{"name":"patients/anna","displayName":"A B"},"updateMask":"height"})",
              {"patient.display_name", "update_mask.paths[0]"}),
      {patients + "UpdatePatient",
       R"({"patient":{"name":"patients/anna","etag":"old"}})",
       StatusCode::ABORTED,
       "FIELD_VIOLATION",
       {"patient.etag"}},
      {patients + "DeletePatient",
       R"({"name":"patients/anna","force":true,"etag":"old"})",
       StatusCode::ABORTED,
       "FIELD_VIOLATION",
       {"etag"}},
      early(patients + "DeletePatient", R"({"name":"patients/anna"})"),
      invalid(patients + "CreateScan", R"({"parent":"patients/anna","format":"OBJ","sizeBytes":"0","sha256":"x"})",
              {"sha256", "size_bytes"}),
      absent(patients + "CreateScan",
             R"({"parent":"patients/berta","format":"OBJ","sizeBytes":"1","validateOnly":true,"sha256":")" +
                 std::string(64, 'a') + "\"}"),
      invalid(patients + "UploadScan", R"({"name":"patients/anna"})", {"name"}),
      absent(patients + "UploadScan", R"({"name":"patients/anna/scans/none"})"),
      absent(patients + "GetScan", R"({"name":"patients/anna/scans/none"})"),
      invalid(patients + "ListScans", R"({"parent":"anna"})", {"parent"}),
      absent(patients + "DeleteScan", R"({"name":"patients/anna/scans/none"})"),
      invalid(patients + "BuildModel", R"({"parent":"patients/anna"})", {"spec"}),
      absent(patients + "BuildModel", R"({"parent":"patients/berta","spec":{},"validateOnly":true})"),
      invalid(patients + "GetModel", R"({"name":"patients/anna/models/none","readMask":"nose,report.vertices"})",
              {"read_mask.paths[0]", "read_mask.paths[1]"}),
      absent(patients + "GetModel", R"({"name":"patients/anna/models/none"})"),
      invalid(patients + "ListModels", R"({"parent":"patients/anna","readMask":"nose"})", {"read_mask.paths[0]"}),
      absent(patients + "DeleteModel", R"({"name":"patients/anna/models/none"})"),
      absent(patients + "DownloadScanMesh", R"({"name":"patients/anna/scans/none"})"),
      absent(patients + "DownloadModelMesh", R"({"name":"patients/anna/models/none"})"),
      absent(patients + "DownloadScanMesh", R"({"name":"patients/anna/scans/none"})"),
  };
}

/// patients/anna has no plan.
std::vector<Row> plan_rows() {
  const std::string plans = "PlanService/";
  return {
      invalid(plans + "CreatePlan", R"({"parent":"anna","planId":"X","plan":{"title":"A B","content":{"scan":{}}}})",
              {"parent", "plan_id"}),
      invalid(plans + "CreatePlan", R"({"parent":"patients/anna","plan":{"title":"A B","content":{"scan":{}}}})",
              {"plan.content.scan", "plan.title"}),
      absent(plans + "CreatePlan", R"({"parent":"patients/anna","plan":{"scan":"patients/anna/scans/none"}})"),
      absent(plans + "CreatePlan", R"({"parent":"patients/berta","validateOnly":true})"),
      invalid(plans + "GetPlan", R"({"name":"patients/anna/plans/none","readMask":"nose"})", {"read_mask.paths[0]"}),
      absent(plans + "GetPlan", R"({"name":"patients/anna/plans/none"})"),
      invalid(plans + "ListPlans", R"({"parent":"anna"})", {"parent"}),
      invalid(plans + "ListPlans", R"({"parent":"patients/-","pageSize":-1})", {"page_size"}),
      absent(plans + "ListPlans", R"({"parent":"patients/berta"})"),
      invalid(plans + "UpdatePlan", R"({"plan":{"name":"patients/anna"},"updateMask":"runs"})",
              {"plan.name", "update_mask"}),
      absent(plans + "UpdatePlan", R"({"plan":{"name":"patients/anna/plans/none"}})"),
      absent(plans + "DeletePlan", R"({"name":"patients/anna/plans/none"})"),
      invalid(plans + "AddPlanRun", R"({"name":"patients/anna/plans/none","simulation":"x"})", {"simulation"}),
      absent(plans + "AddPlanRun", R"({"name":"patients/anna/plans/none","simulation":"simulations/x"})"),
      invalid(plans + "ListPlanRevisions", R"({"parent":"patients/anna"})", {"parent"}),
      absent(plans + "ListPlanRevisions", R"({"parent":"patients/anna/plans/none"})"),
      absent(plans + "GetPlanRevision", R"({"name":"patients/anna/plans/none","revision":"1"})"),
  };
}

std::vector<Row> simulation_rows() {
  const std::string simulations = "SimulationService/";
  const std::string planning = "PlanningService/";
  const std::string forecasts = "ForecastService/";
  return {
      invalid(simulations + "CreateSimulation", R"({"simulationId":"X"})", {"simulation_id", "spec"}),
      absent(simulations + "CreateSimulation",
             R"({"spec":{"model":"patients/anna/models/none","films":[{"name":"f","belowLayer":"skin","nXi":2,"nEta":2,
                 "zones":[{"name":"z","box":{"xiMin":0,"xiMax":1,"etaMin":0,"etaMax":1}}]}]},"validateOnly":true})"),
      invalid(planning + "ProposePlan", R"({"parent":"patients/anna"})", {"spec"}),
      absent(planning + "ProposePlan", R"({"parent":"patients/berta","spec":{}})"),
      invalid(forecasts + "MakeForecast", R"({"parent":"patients/anna"})", {"spec"}),
      absent(forecasts + "MakeForecast", R"({"parent":"patients/berta","spec":{}})"),
      invalid(forecasts + "EstimateRetention", R"({"wantedMl":-1})", {"wanted_ml"}),
      invalid(planning + "PlanDelivery", "{}", {"plan"}),
      absent(planning + "PlanDelivery", R"({"plan":{"model":"patients/anna/models/none"}})"),
      invalid(planning + "ArrangeFace", "{}", {"parts"}),
      absent(planning + "ArrangeFace", R"({"parts":[{"name":"a","plan":{"model":"patients/anna/models/none"}}]})"),
      invalid(simulations + "CheckPlan", "{}", {"spec"}),
      absent(simulations + "CheckPlan", R"({"spec":{"model":"patients/anna/models/none"}})"),
      invalid(simulations + "FindShape", "{}", {"spec"}),
      absent(simulations + "FindShape", R"({"simulation":"simulations/none"})"),
      absent(simulations + "FindShape", R"({"spec":{"model":"patients/anna/models/none"}})"),
      invalid(simulations + "GetSimulation", R"({"name":"simulations/x","readMask":"colour"})", {"read_mask.paths[0]"}),
      absent(simulations + "GetSimulation", R"({"name":"simulations/none"})"),
      invalid(simulations + "ListSimulations", R"({"readMask":"summary.colour"})", {"read_mask.paths[0]"}),
      early(simulations + "StartSimulation", R"({"name":"simulations/y"})"),
      early(simulations + "PauseSimulation", R"({"name":"simulations/x"})"),
      early(simulations + "ResumeSimulation", R"({"name":"simulations/x"})"),
      early(simulations + "StopSimulation", R"({"name":"simulations/y"})"),
      {simulations + "DeleteSimulation",
       R"({"name":"simulations/x","etag":"old"})",
       StatusCode::ABORTED,
       "FIELD_VIOLATION",
       {"etag"}},
      {simulations + "DeleteSimulation",
       R"({"name":"simulations/y","etag":"old"})",
       StatusCode::ABORTED,
       "FIELD_VIOLATION",
       {"etag"}},
      invalid(simulations + "Inject",
              R"({"name":"simulations/x","validateOnly":true,
                  "injection":{"zone":"nowhere","volumeMl":0.01,"rateMlPerS":0.1}})",
              {"injection.zone"}),
      {simulations + "Inject",
       R"({"name":"simulations/x","etag":"old","injection":{"zone":"middle","volumeMl":0.01,"rateMlPerS":0.1}})",
       StatusCode::ABORTED,
       "FIELD_VIOLATION",
       {"etag"}},
      early(simulations + "CreateCheckpoint", R"({"parent":"simulations/y"})"),
      absent(simulations + "GetCheckpoint", R"({"name":"simulations/x/checkpoints/none"})"),
      invalid(simulations + "ListCheckpoints", R"({"parent":"simulations/x","pageSize":-3})", {"page_size"}),
      absent(simulations + "DeleteCheckpoint", R"({"name":"simulations/x/checkpoints/none"})"),
      absent(simulations + "RestoreSimulation", R"({"checkpoint":"simulations/x/checkpoints/none"})"),
      absent(simulations + "GetSeries", R"({"name":"simulations/none"})"),
      invalid(simulations + "EvaluateSimulation", R"({"name":"simulations/x","targetScan":"scan"})", {"target_scan"}),
      invalid(simulations + "EvaluateSimulation",
              R"({"name":"simulations/x","targetScan":"patients/anna/scans/none","rimMm":-1})", {"rim_mm"}),
      absent(simulations + "ExportTissueDeck", R"({"name":"simulations/none"})"),
  };
}

std::vector<Row> other_rows() {
  return {
      absent("OperationService/GetOperation", R"({"name":"operations/none"})"),
      invalid("OperationService/ListOperations", R"({"pageSize":-1})", {"page_size"}),
      invalid("OperationService/WaitOperation", R"({"name":"operations/none","timeout":"61s"})", {"timeout"}),
      absent("OperationService/CancelOperation", R"({"name":"operations/none"})"),
      invalid("PlanningService/MakeTarget", R"({"parent":"patients/anna","spec":{}})", {"spec.scan", "spec.source"}),
      absent("PlanningService/MakeTarget",
             R"({"parent":"patients/anna","spec":{"scan":"patients/anna/scans/none",
                 "surface":{"scan":"patients/anna/scans/none"}}})"),
      invalid("PlanningService/MeasureDeficit", R"({"scan":"scan","rimMm":51})", {"rim_mm", "scan", "target_scan"}),
      absent("PlanningService/MeasureDeficit",
             R"({"scan":"patients/anna/scans/none","targetScan":"patients/anna/scans/none"})"),
      absent("FrameService/Watch", R"({"simulation":"simulations/none"})"),
      invalid("FrameService/Watch", R"({"simulation":"simulations/x","maxRateHz":-1})", {"max_rate_hz"}),
      absent("FrameService/AcknowledgeFrame", R"({"simulation":"simulations/x","viewer":"none"})"),
  };
}

std::vector<Row> all_rows() {
  std::vector<Row> rows = patient_rows();
  for (const auto& more : {plan_rows(), simulation_rows(), other_rows()})
    rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

const google::protobuf::MethodDescriptor* find_method(const std::string& method) {
  v1::MakeTargetRequest::descriptor();  // no stub here makes the linker take the services' files
  v1::MakeForecastRequest::descriptor();
  v1::CreatePlanRequest::descriptor();
  std::string name = "lipofill.v1." + method;
  name[name.find('/')] = '.';
  return google::protobuf::DescriptorPool::generated_pool()->FindMethodByName(name);
}

std::string encode(const google::protobuf::Descriptor* type, const std::string& json) {
  const auto message = std::unique_ptr<google::protobuf::Message>(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(type)->New());
  const auto parsed = google::protobuf::util::JsonStringToMessage(json, message.get());
  EXPECT_TRUE(parsed.ok()) << json << ": " << parsed;
  return message->SerializeAsString();
}

template <typename Detail>
Detail detail_of(const grpc::Status& status) {
  google::rpc::Status rich;
  Detail detail;
  rich.ParseFromString(status.error_details());
  for (const auto& any : rich.details()) {
    if (any.UnpackTo(&detail)) return detail;
  }
  return {};
}

class ErrorTableTest : public RunTest {
 protected:
  ErrorTableTest() {
    create_scan("patients/anna", v1::OBJ, sheet_obj());
    create(1.0, "x", false);
    create(0.05, "y");
    await_end("simulations/y");
  }
};

TEST_F(ErrorTableTest, EveryErrorSaysWhatItIsAndNothingIsChanged) {
  const std::string before = store_content();
  for (const Row& row : all_rows()) {
    const auto* method = find_method(row.method);
    ASSERT_NE(method, nullptr) << row.method;
    const std::string what = row.method + " " + row.request;
    const grpc::Status status = call_raw("/lipofill.v1." + row.method, encode(method->input_type(), row.request));
    EXPECT_EQ(status.error_code(), row.code) << what << ": " << status.error_message();
    EXPECT_FALSE(status.error_message().empty()) << what;
    const auto info = detail_of<google::rpc::ErrorInfo>(status);
    EXPECT_EQ(info.domain(), "lipofill") << what;
    EXPECT_EQ(info.reason(), row.reason) << what;
    Fields fields;
    for (const auto& [field, description] : violations_of(status)) {
      fields.push_back(field);
      EXPECT_FALSE(description.empty()) << what;
    }
    EXPECT_EQ(fields, row.fields) << what << ": " << status.error_message();
  }
  EXPECT_EQ(store_content(), before);
}

TEST(ErrorTable, HasEveryCallOfTheApi) {
  std::set<std::string> tabled;
  for (const Row& row : all_rows()) tabled.insert(row.method);
  const auto* pool = google::protobuf::DescriptorPool::generated_pool();
  for (const char* service :
       {"PatientService", "OperationService", "SimulationService", "FrameService", "PlanService"}) {
    const auto* descriptor = pool->FindServiceByName(std::string("lipofill.v1.") + service);
    ASSERT_NE(descriptor, nullptr) << service;
    for (int i = 0; i < descriptor->method_count(); ++i) {
      const std::string method = std::string(service) + "/" + descriptor->method(i)->name();
      EXPECT_EQ(tabled.count(method), 1u) << method << " has no row";
    }
  }
}

}  // namespace
}  // namespace lipofill::testing
