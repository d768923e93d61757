// Bad input of every kind: each gets an error that names the field, the daemon goes on, and nothing
// half-made stays.

#include <limits>

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using Patients = v1::PatientService::Stub;
using Simulations = v1::SimulationService::Stub;
using ::testing::AnyOf;
using ::testing::Eq;
using ::testing::HasSubstr;

class BadInputTest : public ServiceTest {
 protected:
  BadInputTest() {
    create_patient();
    model_ = build_square();
    before_ = store_content();
  }
  ~BadInputTest() override {
    EXPECT_TRUE(is_serving());
    EXPECT_EQ(store_content(), before_);
  }

  void expect_refused_scan(v1::ScanFormat format, const std::string& bytes, const std::string& what) {
    v1::Scan scan;
    const grpc::Status status = upload("patients/anna", format, bytes, scan);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << what << ": " << status.error_message();
    EXPECT_FALSE(violations_of(status).empty()) << what;
  }
  /// A violation of a field whose path holds `field`, at once or as the operation's error.
  void expect_refused_model(const v1::ModelSpec& spec, const std::string& field) {
    v1::Operation operation;
    const grpc::Status status = build("patients/anna", spec, operation);
    std::map<std::string, std::string> violations;
    if (status.ok()) {
      ASSERT_TRUE(operation.has_error()) << field << " was taken";
      EXPECT_THAT(operation.error().code(), AnyOf(Eq(3), Eq(9))) << operation.error().message();
      violations = violations_of(operation.error());
    } else {
      EXPECT_THAT(status.error_code(),
                  AnyOf(Eq(grpc::StatusCode::INVALID_ARGUMENT), Eq(grpc::StatusCode::FAILED_PRECONDITION)));
      violations = violations_of(status);
    }
    const bool unknown = violations.count("spec") > 0 && violations["spec"].find(field) != std::string::npos;
    EXPECT_TRUE(unknown || names(violations, "spec." + field))
        << field << ": " << status.error_message() << operation.error().message();
  }
  void expect_refused_simulation(const v1::SimulationSpec& spec, const std::string& field) {
    v1::Simulation simulation;
    const grpc::Status status = create_simulation(spec, "", false, simulation);
    EXPECT_THAT(status.error_code(),
                AnyOf(Eq(grpc::StatusCode::INVALID_ARGUMENT), Eq(grpc::StatusCode::FAILED_PRECONDITION)))
        << field << " was taken";
    EXPECT_TRUE(names(violations_of(status), "spec." + field)) << field << ": " << status.error_message();
  }
  static bool names(const std::map<std::string, std::string>& violations, const std::string& field) {
    for (const auto& [path, description] : violations) {
      if (path.rfind(field, 0) == 0 && !description.empty()) return true;
    }
    return false;
  }

  v1::Model model_;
  std::string before_;
};

TEST_F(BadInputTest, Scans) {
  std::string garbage;
  for (uint32_t i = 0, x = 12345; i < 5000; ++i, x = x * 1664525 + 1013904223) garbage += static_cast<char>(x >> 24);
  const std::string sheet = sheet_obj();
  for (const auto format : {v1::OBJ, v1::PLY, v1::STL}) {
    expect_refused_scan(format, garbage, "garbage");
    expect_refused_scan(format, "\n", "nothing in it");
    expect_refused_scan(format, std::string(1000, '\0'), "zeros");
  }
  expect_refused_scan(v1::PLY, sheet, "an OBJ as PLY");
  expect_refused_scan(v1::STL, sheet, "an OBJ as STL");
  expect_refused_scan(v1::OBJ, "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "NaN");
  expect_refused_scan(v1::OBJ, "v 0 0 1e300\nv 100 0 0\nv 0 100 0\nf 1 2 3\n", "huge numbers");
  expect_refused_scan(v1::OBJ, "v 0 0 0\nv 100 0 0\nv 0 100 0\nf 1 2 4\n", "an index out of range");
  expect_refused_scan(v1::OBJ, "v 0 0 0\nv 100 0 0\nv 0 100 0\n", "no faces");
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  expect_refused_scan(v1::PLY, ply + std::string(100, 'x'), "a header that promises more than there is");
  std::string stl(84, '\0');
  stl[80] = 100;  // a hundred triangles announced, none there
  expect_refused_scan(v1::STL, stl, "a truncated STL");
}

TEST_F(BadInputTest, Models) {
  const v1::ModelSpec good = square_spec();
  v1::ModelSpec spec = good;
  spec.mutable_layers(0)->mutable_thickness_mm()->set_constant(-1);
  expect_refused_model(spec, "layers[0].thickness_mm");
  spec = good;
  spec.mutable_layers(1)->set_youngs_modulus_kpa(-5);
  expect_refused_model(spec, "layers[1].youngs_modulus_kpa");
  for (const double nu : {-0.1, 0.5, 0.7}) {
    spec = good;
    spec.mutable_layers(0)->set_poisson_ratio(nu);
    expect_refused_model(spec, "layers[0].poisson_ratio");
  }
  spec = good;
  spec.mutable_layers(0)->set_density_kg_m3(0);
  expect_refused_model(spec, "layers[0].density_kg_m3");
  spec = good;
  spec.set_n_xi(0);
  expect_refused_model(spec, "n_xi");
  spec.set_n_xi(4'000'000'000u);
  expect_refused_model(spec, "n_xi");
  spec = good;
  spec.mutable_square()->set_length_xi_mm(0);
  expect_refused_model(spec, "square.length_xi_mm");
  spec.mutable_square()->set_length_xi_mm(std::numeric_limits<double>::quiet_NaN());
  expect_refused_model(spec, "square.length_xi_mm");
  spec = good;
  spec.clear_square();
  expect_refused_model(spec, "square");
  spec = good;
  spec.mutable_rim()->set_kind(static_cast<v1::Support::Kind>(17));
  expect_refused_model(spec, "rim.kind");
  spec = good;
  spec.GetReflection()->MutableUnknownFields(&spec)->AddVarint(77, 1);
  expect_refused_model(spec, "lipofill.v1.ModelSpec");
  expect_refused_model(v1::ModelSpec(), "square");
}

TEST_F(BadInputTest, Simulations) {
  const v1::SimulationSpec good = square_plan(model_.name(), 1.0);
  v1::SimulationSpec spec = good;
  spec.mutable_films(0)->mutable_rest_thickness_mm()->set_constant(-0.1);
  expect_refused_simulation(spec, "films[0].rest_thickness_mm");
  spec = good;
  spec.mutable_fat()->set_viscosity_pa_s(-1);
  expect_refused_simulation(spec, "fat.viscosity_pa_s");
  spec = good;
  spec.mutable_injections(0)->set_volume_ml(1e9);
  expect_refused_simulation(spec, "injections[0].volume_ml");
  spec = good;
  spec.mutable_injections(0)->set_zone("nowhere");
  expect_refused_simulation(spec, "injections[0].zone");
  spec = good;
  auto* box = spec.mutable_films(0)->mutable_zones(0)->mutable_box();
  box->set_xi_min(2.0);
  box->set_xi_max(3.0);
  expect_refused_simulation(spec, "films[0].zones[0]");
  spec = good;
  spec.mutable_films(0)->set_below_layer("bone");
  expect_refused_simulation(spec, "films[0].below_layer");
  spec = good;
  spec.mutable_films(0)->set_n_xi(200);
  expect_refused_simulation(spec, "films[0]");
  spec = good;
  spec.mutable_time()->set_step_ms(-10);
  expect_refused_simulation(spec, "time.step_ms");
  spec = good;
  spec.mutable_time()->set_max_injection_step_ms(0.5);
  expect_refused_simulation(spec, "time.max_injection_step_ms");
  spec = good;
  spec.mutable_time()->set_goal(static_cast<v1::TimeControl::Goal>(7));
  expect_refused_simulation(spec, "time.goal");
  spec = good;
  spec.mutable_time()->set_end_s(std::numeric_limits<double>::infinity());
  expect_refused_simulation(spec, "time.end_s");
  spec = good;
  spec.mutable_probes(0)->mutable_place()->mutable_chart()->set_xi(9);
  expect_refused_simulation(spec, "probes[0]");
  spec = good;
  spec.set_coupling(static_cast<v1::Coupling>(9));
  expect_refused_simulation(spec, "coupling");
  spec = good;
  auto* film = spec.mutable_films(0);
  film->GetReflection()->MutableUnknownFields(film)->AddVarint(999, 1);
  expect_refused_simulation(spec, "films[0]");
  spec = good;
  spec.set_model("models/x");
  expect_refused_simulation(spec, "model");
  expect_refused_simulation(v1::SimulationSpec(), "model");
  v1::Simulation simulation;
  spec.set_model("patients/anna/models/none");
  EXPECT_EQ(create_simulation(spec, "", false, simulation).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(BadInputTest, InjectionsOnTheWay) {
  v1::Simulation simulation;
  ASSERT_TRUE(create_simulation(square_plan(model_.name(), 1.0), "x", false, simulation).ok());
  v1::InjectRequest request;
  request.set_name("simulations/x");
  for (const auto& [text, field] : std::map<std::string, std::string>{
           {"zone: 'nowhere' volume_ml: 0.01 rate_ml_per_s: 0.1", "injection.zone"},
           {"zone: 'middle' volume_ml: 1e9 rate_ml_per_s: 0.1", "injection.volume_ml"},
           {"zone: 'middle' volume_ml: 0.01 rate_ml_per_s: -1", "injection.rate_ml_per_s"},
           {"zone: 'middle' volume_ml: nan rate_ml_per_s: 1", "injection.volume_ml"},
           {"zone: 'middle'", "injection.rate_ml_per_s"}}) {
    *request.mutable_injection() = parse_text<v1::Injection>(text);
    const grpc::Status status = call(*simulations_, &Simulations::Inject, request, simulation);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << text;
    EXPECT_TRUE(names(violations_of(status), field)) << text << ": " << status.error_message();
  }
  v1::DeleteSimulationRequest remove;
  remove.set_name("simulations/x");
  google::protobuf::Empty nothing;
  EXPECT_TRUE(call(*simulations_, &Simulations::DeleteSimulation, remove, nothing).ok());
}

TEST_F(BadInputTest, NamesIdsAndTokens) {
  v1::CreatePatientRequest create;
  create.set_patient_id("../../etc/passwd");
  create.set_request_id(std::string(100, 'r'));
  create.set_display_name("Anna Smith");
  (*create.mutable_labels())["Born"] = "1970-01-01";
  v1::Patient patient;
  const auto violations = violations_of(call(*patients_, &Patients::CreatePatient, create, patient));
  for (const char* field : {"patient_id", "request_id", "display_name", "labels"}) {
    EXPECT_EQ(violations.count(field), 1u) << field;
  }
  v1::GetPatientRequest get;
  get.set_name("patients/" + std::string(10'000, 'x'));
  const grpc::Status status = call(*patients_, &Patients::GetPatient, get, patient);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_LT(status.error_message().size(), 500u);
  v1::ListSimulationsRequest list;
  list.set_page_token("made-up");
  v1::ListSimulationsResponse none;
  EXPECT_EQ(violations_of(call(*simulations_, &Simulations::ListSimulations, list, none)).count("page_token"), 1u);
  list.clear_page_token();
  list.set_page_size(-1);
  EXPECT_EQ(violations_of(call(*simulations_, &Simulations::ListSimulations, list, none)).count("page_size"), 1u);
}

TEST_F(BadInputTest, TooLargeAMessage) {
  v1::CreatePatientRequest create;
  (*create.mutable_labels())["a"] = std::string(size_t{5} << 20, 'x');
  v1::Patient patient;
  EXPECT_EQ(call(*patients_, &Patients::CreatePatient, create, patient).error_code(),
            grpc::StatusCode::RESOURCE_EXHAUSTED);
}

class BadScanRegionTest : public ServiceTest {};

TEST_F(BadScanRegionTest, LandmarksOffTheSurfaceAndCornersTheWrongWayRound) {
  create_patient();
  v1::Scan scan;
  ASSERT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(40), scan).ok());
  const std::string before = store_content();
  v1::ModelSpec spec = square_spec();
  auto* region = spec.mutable_scan_region();
  region->set_scan(scan.name());
  for (const auto& [x, y] : std::vector<std::pair<double, double>>{{20, 20}, {80, 20}, {80, 80}, {20, 80}}) {
    auto* position = region->add_corners()->mutable_position_mm();
    position->set_x(x);
    position->set_y(y);
    position->set_z(3);
  }
  const auto refused = [&](const v1::ModelSpec& bad, const std::string& what) {
    v1::Operation operation;
    const grpc::Status status = build("patients/anna", bad, operation);
    const bool failed = !status.ok() || operation.has_error();
    EXPECT_TRUE(failed) << what;
    const auto code = status.ok() ? operation.error().code() : static_cast<int>(status.error_code());
    EXPECT_THAT(code, AnyOf(Eq(3), Eq(9))) << what << operation.error().message();
  };
  v1::ModelSpec bad = spec;
  bad.mutable_scan_region()->mutable_corners(1)->mutable_position_mm()->set_z(500);
  refused(bad, "a corner far off the surface");
  bad = spec;
  bad.mutable_scan_region()->mutable_corners()->SwapElements(1, 3);
  refused(bad, "corners clockwise");
  bad = spec;
  (*bad.mutable_scan_region()->mutable_corners(0)->mutable_landmarks()->mutable_weights())["nowhere"] = 1.0;
  refused(bad, "an unknown landmark");
  bad = spec;
  bad.mutable_scan_region()->mutable_corners()->RemoveLast();
  refused(bad, "three corners");
  bad = spec;
  bad.mutable_scan_region()->set_scan("patients/berta/scans/s1");
  refused(bad, "another patient's scan");
  EXPECT_EQ(store_content(), before);
  EXPECT_TRUE(is_serving());
}

}  // namespace
}  // namespace lipofill::testing
