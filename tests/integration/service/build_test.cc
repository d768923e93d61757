// Patients, models and the operations that build them.

#include <algorithm>

#include "absl/strings/str_format.h"
#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using Patients = v1::PatientService::Stub;
using Operations = v1::OperationService::Stub;
using ::testing::HasSubstr;

class BuildTest : public ServiceTest {
 protected:
  BuildTest() { create_patient(); }

  v1::BuildModelRequest request(const v1::ModelSpec& spec, const std::string& request_id = "") {
    v1::BuildModelRequest request;
    request.set_parent("patients/anna");
    request.set_request_id(request_id);
    *request.mutable_spec() = spec;
    return request;
  }
  int n_models() {
    v1::ListModelsRequest list;
    list.set_parent("patients/anna");
    v1::ListModelsResponse models;
    EXPECT_TRUE(call(*patients_, &Patients::ListModels, list, models).ok());
    return models.models_size();
  }
};

TEST_F(BuildTest, PatientsHaveLabelsPagesAndRequests) {
  v1::CreatePatientRequest create;
  create.set_request_id("r1");
  create.set_display_name("case-7");
  (*create.mutable_labels())["side"] = "left";
  v1::Patient first, again;
  ASSERT_TRUE(call(*patients_, &Patients::CreatePatient, create, first).ok());
  ASSERT_TRUE(call(*patients_, &Patients::CreatePatient, create, again).ok());
  EXPECT_EQ(first.SerializeAsString(), again.SerializeAsString());
  for (const char* id : {"berta", "carl", "dora"}) create_patient(id);

  std::vector<std::string> names;
  v1::ListPatientsRequest list;
  list.set_page_size(2);
  v1::ListPatientsResponse page;
  do {
    ASSERT_TRUE(call(*patients_, &Patients::ListPatients, list, page).ok());
    EXPECT_LE(page.patients_size(), 2);
    for (const auto& patient : page.patients()) names.push_back(patient.name());
    list.set_page_token(page.next_page_token());
  } while (!page.next_page_token().empty());
  EXPECT_EQ(names.size(), 5u);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));

  v1::UpdatePatientRequest update;
  *update.mutable_patient() = first;
  update.mutable_patient()->set_display_name("Anna Smith");
  const grpc::Status refused = call(*patients_, &Patients::UpdatePatient, update, again);
  EXPECT_EQ(violations_of(refused).count("patient.display_name"), 1u) << "a name is no pseudonym";
  update.mutable_patient()->set_display_name("case-8");
  ASSERT_TRUE(call(*patients_, &Patients::UpdatePatient, update, again).ok());
  EXPECT_EQ(again.display_name(), "case-8");
  EXPECT_EQ(again.create_time().nanos(), first.create_time().nanos());
}

TEST_F(BuildTest, BuildsASquareAndShowsItsMeshes) {
  const v1::Model model = build_square();
  EXPECT_EQ(model.report().hexahedra(), 128u);
  EXPECT_EQ(model.report().nodes(), 243u);
  EXPECT_NEAR(model.report().area_cm2(), 16.0, 1e-9);
  EXPECT_NEAR(model.report().tissue_volume_ml(), 9.6, 1e-9);
  EXPECT_NEAR(model.report().min_scaled_jacobian(), 1.0, 1e-12);
  EXPECT_EQ(model.report().content_hash().size(), 64u);

  restart();
  v1::GetModelRequest get;
  get.set_name(model.name());
  v1::Model kept;
  ASSERT_TRUE(call(*patients_, &Patients::GetModel, get, kept).ok());
  EXPECT_EQ(kept.SerializeAsString(), model.SerializeAsString());

  Context context;
  v1::DownloadModelMeshRequest download;
  download.set_name(model.name());
  auto stream = patients_->DownloadModelMesh(&context, download);
  auto rows = read_mesh_rows(*stream);
  EXPECT_EQ(rows["skin.points"], 81u);
  EXPECT_EQ(rows["skin.cells"], 64u);
  EXPECT_EQ(rows["tissue.cells"], 128u);
  EXPECT_EQ(rows.count("scan.points"), 0u);
}

TEST_F(BuildTest, BuildsOnAScanAndMeasuresItsSkin) {
  v1::Scan scan;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(60), scan).ok());
  v1::ModelSpec spec = square_spec();
  spec.mutable_scan_region()->set_scan(scan.name());
  for (const auto& [x, y] : std::vector<std::pair<double, double>>{{25, 25}, {75, 25}, {75, 75}, {25, 75}}) {
    auto* position = spec.mutable_scan_region()->add_corners()->mutable_position_mm();
    position->set_x(x);
    position->set_y(y);
    position->set_z(4.5);
  }
  *spec.mutable_scan_region()->mutable_axes() =
      parse_text<v1::HeadAxes>("left { x: 1 y: 0 z: 0 } up { x: 0 y: 1 z: 0 } forward { x: 0 y: 0 z: 1 }");
  v1::Operation operation;
  const grpc::Status built = build("patients/anna", spec, operation);
  ASSERT_TRUE(built.ok()) << built.error_message();
  v1::Model model;
  ASSERT_TRUE(operation.response().UnpackTo(&model)) << operation.error().message();
  EXPECT_GT(model.report().scan_vertices_in_patch(), 500u);
  v1::DeleteScanRequest remove;
  remove.set_name(scan.name());
  google::protobuf::Empty nothing;
  EXPECT_EQ(call(*patients_, &Patients::DeleteScan, remove, nothing).error_code(),
            grpc::StatusCode::FAILED_PRECONDITION);

  v1::Simulation simulation;
  const grpc::Status created = create_simulation(square_plan(model.name(), 0.2), "x", true, simulation);
  ASSERT_TRUE(created.ok()) << created.error_message();
  simulation = await_end("simulations/x");
  ASSERT_EQ(simulation.state(), v1::Simulation::FINISHED) << simulation.reason();
  restart();
  v1::EvaluateSimulationRequest evaluate;
  evaluate.set_name("simulations/x");
  evaluate.set_target_scan(scan.name());
  v1::Evaluation evaluation;
  const grpc::Status measured =
      call(*simulations_, &v1::SimulationService::Stub::EvaluateSimulation, evaluate, evaluation);
  ASSERT_TRUE(measured.ok()) << measured.error_message();
  EXPECT_EQ(evaluation.mesh(), "scan");
  EXPECT_EQ(static_cast<uint32_t>(evaluation.vertices_size()), model.report().scan_vertices_in_patch());
  EXPECT_NEAR(evaluation.before_to_target().max_mm(), 0.0, 1e-6) << "the target is the scan itself";
  EXPECT_GT(evaluation.simulated_to_target().max_mm(), 0.5 * simulation.summary().skin_max_displacement_mm());
}

TEST_F(BuildTest, MeasuresTheWayDownToTheBoneAndKeepsIt) {
  v1::Scan skin, bone;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(60), skin).ok());
  // The same sheet without height is a plane up to 5 mm under it.
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(20, 0.0), bone).ok());
  v1::ModelSpec spec = parse_text<v1::ModelSpec>(R"(
    n_xi: 10 n_eta: 10 tissue_preset: ELASTOGRAPHY
    layers { name: "skin" thickness_mm { constant: 0.5 } } layers { name: "muscle" down_to_bone { min_thickness_mm: 0.5 } }
    scan_region { axes { left { x: 1 y: 0 z: 0 } up { x: 0 y: 1 z: 0 } forward { x: 0 y: 0 z: 1 } } })");
  spec.mutable_scan_region()->set_scan(skin.name());
  spec.mutable_scan_region()->set_bone_scan(bone.name());
  for (const auto& [x, y] : std::vector<std::pair<double, double>>{{25, 25}, {75, 25}, {75, 75}, {25, 75}}) {
    *spec.mutable_scan_region()->add_corners()->mutable_position_mm() =
        parse_text<v1::Vector3>(absl::StrFormat("x: %g y: %g z: 4.5", x, y));
  }
  v1::Operation operation;
  const grpc::Status built = build("patients/anna", spec, operation);
  ASSERT_TRUE(built.ok()) << built.error_message();
  v1::Model model;
  ASSERT_TRUE(operation.response().UnpackTo(&model)) << operation.error().message();
  const v1::ModelReport& report = model.report();
  EXPECT_EQ(report.bone().measured_share(), 1.0);
  ASSERT_EQ(report.layers_size(), 2);
  EXPECT_NEAR(report.layers(1).mean_thickness_mm(), report.bone().mean_depth_mm() - 0.5, 1e-9);
  EXPECT_LT(report.bone().max_depth_mm(), 5.05);
  EXPECT_EQ(model.spec().layers(1).youngs_modulus_kpa(), 20.0) << "the preset shows";
  EXPECT_EQ(model.spec().layers(0).poisson_ratio(), 0.48);

  v1::DeleteScanRequest remove;
  remove.set_name(bone.name());
  google::protobuf::Empty nothing;
  EXPECT_EQ(call(*patients_, &Patients::DeleteScan, remove, nothing).error_code(),
            grpc::StatusCode::FAILED_PRECONDITION);
  restart();
  v1::Simulation simulation;
  v1::SimulationSpec plan = square_plan(model.name(), 0.02);
  EXPECT_TRUE(create_simulation(plan, "x", true, simulation).ok()) << "the model is built again from both scans";
  EXPECT_EQ(await_end("simulations/x").state(), v1::Simulation::FINISHED);

  spec.mutable_layers(1)->mutable_down_to_bone()->set_min_thickness_mm(4.9);
  ASSERT_TRUE(build("patients/anna", spec, operation).ok());
  EXPECT_EQ(violations_of(operation.error()).count("spec.layers[1].down_to_bone"), 1u) << operation.error().message();
  spec.mutable_scan_region()->set_bone_scan("patients/berta/scans/b");
  EXPECT_EQ(violations_of(build("patients/anna", spec, operation)).count("spec.scan_region.bone_scan"), 1u);
}

TEST_F(BuildTest, IsIdempotentAlsoAfterARestart) {
  v1::Operation first, again;
  ASSERT_TRUE(call(*patients_, &Patients::BuildModel, request(square_spec(), "r1"), first).ok());
  ASSERT_TRUE(call(*patients_, &Patients::BuildModel, request(square_spec(), "r1"), again).ok());
  EXPECT_EQ(first.name(), again.name());
  v1::WaitOperationRequest wait;
  wait.set_name(first.name());
  while (!first.done()) ASSERT_TRUE(call(*operations_, &Operations::WaitOperation, wait, first).ok());
  restart();
  EXPECT_EQ(call(*operations_, &Operations::WaitOperation, wait, again).error_code(), grpc::StatusCode::NOT_FOUND);
  ASSERT_TRUE(call(*patients_, &Patients::BuildModel, request(square_spec(), "r1"), again).ok());
  ASSERT_TRUE(again.done());
  v1::Model before, after;
  ASSERT_TRUE(first.response().UnpackTo(&before));
  ASSERT_TRUE(again.response().UnpackTo(&after));
  EXPECT_EQ(before.name(), after.name());
  EXPECT_EQ(n_models(), 1);
}

TEST_F(BuildTest, ACancelledBuildLeavesNothing) {
  // Both builders get long work; what waits behind them is cancelled before it begins.
  v1::ModelSpec large = square_spec();
  large.set_n_xi(300);
  large.set_n_eta(300);
  for (v1::TissueLayer& layer : *large.mutable_layers()) layer.set_elements_through(1);
  std::vector<v1::Operation> operations(4);
  for (auto& operation : operations) {
    ASSERT_TRUE(call(*patients_, &Patients::BuildModel, request(large), operation).ok());
  }
  v1::Operation& last = operations.back();
  v1::CancelOperationRequest cancel;
  cancel.set_name(last.name());
  google::protobuf::Empty nothing;
  ASSERT_TRUE(call(*operations_, &Operations::CancelOperation, cancel, nothing).ok());
  v1::WaitOperationRequest wait;
  wait.mutable_timeout()->set_seconds(60);
  int models = 0;
  for (auto& operation : operations) {
    wait.set_name(operation.name());
    double progress = 0.0;
    while (!operation.done()) {
      wait.set_seen_progress(operation.progress());
      ASSERT_TRUE(call(*operations_, &Operations::WaitOperation, wait, operation).ok());
      EXPECT_GE(operation.progress(), progress);
      progress = operation.progress();
    }
    if (operation.has_response()) ++models;
  }
  EXPECT_EQ(last.error().code(), static_cast<int>(grpc::StatusCode::CANCELLED)) << last.DebugString();
  EXPECT_EQ(models, 3);
  EXPECT_EQ(n_models(), models);
}

TEST_F(BuildTest, DeletesWhatNothingNeeds) {
  const v1::Model model = build_square();
  v1::DeletePatientRequest remove;
  remove.set_name("patients/anna");
  google::protobuf::Empty nothing;
  const grpc::Status refused = call(*patients_, &Patients::DeletePatient, remove, nothing);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(refused.error_message(), HasSubstr("1 models"));
  v1::Scan scan;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(), scan).ok());
  remove.set_force(true);
  ASSERT_TRUE(call(*patients_, &Patients::DeletePatient, remove, nothing).ok());
  EXPECT_THAT(store_content(), HasSubstr("0 files of scans"));
  EXPECT_EQ(call(*patients_, &Patients::DeletePatient, remove, nothing).error_code(), grpc::StatusCode::NOT_FOUND);
}

}  // namespace
}  // namespace lipofill::testing
