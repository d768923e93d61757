// Field masks, etags and requests that are only checked.

#include "tests/integration/service/run_fixture.h"

namespace lipofill::testing {
namespace {

using Patients = v1::PatientService::Stub;
using Simulations = v1::SimulationService::Stub;

class PartialCallsTest : public RunTest {
 protected:
  v1::Patient update(const std::string& request) {
    v1::Patient patient;
    const grpc::Status status =
        call(*patients_, &Patients::UpdatePatient, parse_text<v1::UpdatePatientRequest>(request), patient);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return patient;
  }
  v1::Patient get_patient() {
    v1::GetPatientRequest request;
    request.set_name("patients/anna");
    v1::Patient patient;
    EXPECT_TRUE(call(*patients_, &Patients::GetPatient, request, patient).ok());
    return patient;
  }
  grpc::Status inject(const std::string& more, v1::Simulation& simulation) {
    const auto request = parse_text<v1::InjectRequest>(
        "name: 'simulations/x' injection { zone: 'middle' volume_ml: 0.01 rate_ml_per_s: 0.1 } " + more);
    return call(*simulations_, &Simulations::Inject, request, simulation);
  }
};

TEST_F(PartialCallsTest, AnUpdateReplacesWhatItsMaskNames) {
  update("patient { name: 'patients/anna' display_name: 'a-1' labels { key: 'side' value: 'left' } }");
  update("patient { name: 'patients/anna' display_name: 'a-2' } update_mask { paths: 'display_name' }");
  EXPECT_EQ(get_patient().display_name(), "a-2");
  EXPECT_EQ(get_patient().labels().at("side"), "left");
  update("patient { name: 'patients/anna' } update_mask { paths: 'labels' }");
  EXPECT_EQ(get_patient().display_name(), "a-2");
  EXPECT_TRUE(get_patient().labels().empty());
}

TEST_F(PartialCallsTest, AnEtagTellsWhetherSomebodyElseWasFirst) {
  const std::string etag = get_patient().etag();
  EXPECT_FALSE(etag.empty());
  EXPECT_EQ(get_patient().etag(), etag);
  const v1::Patient changed = update("patient { name: 'patients/anna' display_name: 'a-1' etag: '" + etag + "' }");
  EXPECT_EQ(changed.display_name(), "a-1");
  EXPECT_NE(changed.etag(), etag);
  v1::Patient patient;
  const auto again = parse_text<v1::UpdatePatientRequest>(
      "patient { name: 'patients/anna' display_name: 'a-2' etag: '" + etag + "' }");
  const grpc::Status refused = call(*patients_, &Patients::UpdatePatient, again, patient);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(get_patient().display_name(), "a-1");
}

TEST_F(PartialCallsTest, OfTwoWhoInjectUponWhatTheySawOneIsRefused) {
  const v1::Simulation seen = create(1.0, "x", false);
  v1::Simulation first;
  ASSERT_TRUE(inject("request_id: 'r1' etag: '" + seen.etag() + "'", first).ok());
  EXPECT_NE(first.etag(), seen.etag());
  v1::Simulation second;
  EXPECT_EQ(inject("etag: '" + seen.etag() + "'", second).error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(get_simulation("simulations/x").spec().injections_size(), first.spec().injections_size());
  // The first one's call, repeated because its answer was lost, is not a second one.
  EXPECT_TRUE(inject("request_id: 'r1' etag: '" + seen.etag() + "'", second).ok());
}

TEST_F(PartialCallsTest, AReadMaskLeavesWhatItNames) {
  create(1.0, "x", false);
  v1::Simulation simulation;
  const auto get = parse_text<v1::GetSimulationRequest>(
      "name: 'simulations/x' read_mask { paths: 'state' paths: 'summary.film_cells' }");
  ASSERT_TRUE(call(*simulations_, &Simulations::GetSimulation, get, simulation).ok());
  v1::Simulation wanted;
  wanted.set_state(v1::Simulation::READY);
  wanted.mutable_summary()->set_film_cells(get_simulation("simulations/x").summary().film_cells());
  EXPECT_GT(wanted.summary().film_cells(), 0u);
  EXPECT_EQ(simulation.DebugString(), wanted.DebugString());

  v1::ListSimulationsResponse list;
  const auto request = parse_text<v1::ListSimulationsRequest>("read_mask { paths: 'name' }");
  ASSERT_TRUE(call(*simulations_, &Simulations::ListSimulations, request, list).ok());
  ASSERT_EQ(list.simulations_size(), 1);
  EXPECT_EQ(list.simulations(0).ShortDebugString(), "name: \"simulations/x\"");

  v1::Model model;
  const auto get_model =
      parse_text<v1::GetModelRequest>("name: '" + model_.name() + "' read_mask { paths: 'create_time' }");
  ASSERT_TRUE(call(*patients_, &Patients::GetModel, get_model, model).ok());
  EXPECT_TRUE(model.name().empty());
  EXPECT_TRUE(model.has_create_time());
  EXPECT_FALSE(model.has_spec());
}

TEST_F(PartialCallsTest, ARequestThatIsOnlyCheckedLeavesNothing) {
  create(1.0, "x", false);
  const std::string before = store_content();

  v1::CreatePatientRequest create_patient;
  create_patient.set_patient_id("berta");
  create_patient.set_validate_only(true);
  v1::Patient patient;
  EXPECT_TRUE(call(*patients_, &Patients::CreatePatient, create_patient, patient).ok());
  EXPECT_EQ(patient.name(), "patients/berta");
  EXPECT_EQ(update("patient { name: 'patients/anna' display_name: 'new' } validate_only: true").display_name(), "new");

  v1::CreateScanRequest create_scan;
  create_scan.set_parent("patients/anna");
  create_scan.set_format(v1::PLY);
  create_scan.set_size_bytes(10);
  create_scan.set_sha256(std::string(64, 'a'));
  create_scan.set_validate_only(true);
  v1::Scan scan;
  EXPECT_TRUE(call(*patients_, &Patients::CreateScan, create_scan, scan).ok());

  v1::BuildModelRequest build;
  build.set_parent("patients/anna");
  *build.mutable_spec() = square_spec();
  build.set_validate_only(true);
  v1::Operation operation;
  EXPECT_TRUE(call(*patients_, &Patients::BuildModel, build, operation).ok());
  EXPECT_TRUE(operation.done());
  EXPECT_TRUE(operation.name().empty());
  v1::Model model;
  EXPECT_TRUE(operation.response().UnpackTo(&model));
  EXPECT_TRUE(model.has_spec());

  build.mutable_spec()->mutable_layers(0)->set_poisson_ratio(0.7);
  const grpc::Status refused = call(*patients_, &Patients::BuildModel, build, operation);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(violations_of(refused).count("spec.layers[0].poisson_ratio"), 1u);

  v1::CreateSimulationRequest create_simulation;
  create_simulation.set_simulation_id("z");
  *create_simulation.mutable_spec() = square_plan(model_.name(), 1.0);
  create_simulation.set_validate_only(true);
  create_simulation.set_start(true);
  v1::Simulation simulation;
  EXPECT_TRUE(call(*simulations_, &Simulations::CreateSimulation, create_simulation, simulation).ok());
  EXPECT_EQ(simulation.state(), v1::Simulation::READY);
  EXPECT_EQ(simulation.summary().film_cells(), get_simulation("simulations/x").summary().film_cells());

  const int planned = get_simulation("simulations/x").spec().injections_size();
  EXPECT_TRUE(inject("validate_only: true", simulation).ok());
  ASSERT_EQ(simulation.spec().injections_size(), planned + 1);
  EXPECT_TRUE(simulation.spec().injections(planned).has_start_s());
  EXPECT_EQ(store_content(), before);
}

}  // namespace
}  // namespace lipofill::testing
