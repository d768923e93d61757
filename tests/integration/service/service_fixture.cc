#include "tests/integration/service/service_fixture.h"

#include <grpcpp/generic/generic_stub.h>

#include <cmath>
#include <sstream>
#include <thread>

#include "core/base/hash.h"

namespace lipofill::testing {
namespace {

std::string sha256_of(const std::string& bytes) {
  Hasher hasher;
  hasher.add_bytes(bytes.data(), bytes.size());
  return hasher.hex_digest();
}

void append(std::map<std::string, std::string>& arrays, const v1::ArraySlice& slice) {
  EXPECT_EQ(arrays[slice.name()].size(), slice.offset_bytes()) << slice.name();
  arrays[slice.name()] += slice.data();
}

}  // namespace

std::map<std::string, std::string> violations_of(const google::rpc::Status& status) {
  std::map<std::string, std::string> violations;
  for (const auto& detail : status.details()) {
    google::rpc::BadRequest bad;
    if (!detail.UnpackTo(&bad)) continue;
    for (const auto& violation : bad.field_violations()) violations[violation.field()] = violation.description();
  }
  return violations;
}

std::map<std::string, std::string> violations_of(const grpc::Status& status) {
  google::rpc::Status message;
  EXPECT_TRUE(message.ParseFromString(status.error_details()));
  EXPECT_EQ(message.code(), status.error_code());
  return violations_of(message);
}

Watcher::Watcher(grpc::ChannelInterface& channel, const v1::WatchRequest& request)
    : stub_(v1::FrameService::NewStub(std::shared_ptr<grpc::ChannelInterface>(&channel, [](auto*) {}))),
      stream_(stub_->Watch(&context_, request)) {}

bool Watcher::next(SeenFrame& frame) {
  frame = {};
  v1::WatchResponse response;
  while (stream_->Read(&response)) {
    if (response.has_mesh()) {
      topology_hash = response.mesh().topology_hash();
      for (const auto& array : response.mesh().arrays()) append(meshes, array);
      continue;
    }
    if (response.has_heartbeat()) {
      heartbeats.push_back(response.heartbeat());
      continue;
    }
    frame.slice = response.frame();
    frame.skipped = response.frame().skipped_frames();
    for (v1::ArraySlice array : response.frame().fields()) {
      append(frame.bytes, array);
      array.clear_data();
      frame.arrays[array.name()] = std::move(array);
    }
    frame.slice.clear_fields();
    if (response.frame().last()) return true;
  }
  return false;
}

int Watcher::drain(SeenFrame* last) {
  int n = 0;
  SeenFrame frame;
  while (next(frame)) {
    ++n;
    if (last != nullptr) *last = frame;
  }
  return n;
}

std::map<std::string, uint64_t> read_mesh_rows(grpc::ClientReader<v1::MeshSlice>& stream) {
  v1::MeshSlice slice;
  std::map<std::string, uint64_t> rows;
  while (stream.Read(&slice)) {
    for (const auto& array : slice.arrays()) rows[array.name()] = array.shape(0);
  }
  EXPECT_TRUE(stream.Finish().ok());
  EXPECT_TRUE(slice.last());
  return rows;
}

ServiceTest::ServiceTest(std::vector<std::string> arguments) : arguments_(std::move(arguments)) {
  connect();
}

void ServiceTest::connect() {
  daemon_ = std::make_unique<DaemonProcess>(directory_.file("data"), arguments_);
  channel_ = grpc::CreateChannel(daemon_->address(), grpc::InsecureChannelCredentials());
  patients_ = v1::PatientService::NewStub(channel_);
  operations_ = v1::OperationService::NewStub(channel_);
  simulations_ = v1::SimulationService::NewStub(channel_);
  frames_ = v1::FrameService::NewStub(channel_);
}

void ServiceTest::restart() {
  EXPECT_EQ(daemon_->terminate(), 0);
  connect();
}

void ServiceTest::restart_hard() {
  daemon_->kill_hard();
  connect();
}

v1::Patient ServiceTest::create_patient(const std::string& id) {
  v1::CreatePatientRequest request;
  request.set_patient_id(id);
  v1::Patient patient;
  const grpc::Status status = call(*patients_, &v1::PatientService::Stub::CreatePatient, request, patient);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return patient;
}

v1::Scan ServiceTest::create_scan(const std::string& patient, v1::ScanFormat format, const std::string& bytes) {
  v1::CreateScanRequest request;
  request.set_parent(patient);
  request.set_format(format);
  request.set_size_bytes(bytes.size());
  request.set_sha256(sha256_of(bytes));
  v1::Scan scan;
  const grpc::Status status = call(*patients_, &v1::PatientService::Stub::CreateScan, request, scan);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return scan;
}

grpc::Status ServiceTest::send(const v1::Scan& scan, uint64_t offset, const std::string& data, v1::Scan& result) {
  constexpr size_t kChunk = 256 * 1024;
  Context context;
  auto stream = patients_->UploadScan(&context, &result);
  for (size_t begin = 0; begin == 0 || begin < data.size(); begin += kChunk) {
    v1::UploadScanRequest chunk;
    if (begin == 0) chunk.set_name(scan.name());
    chunk.set_offset(offset + begin);
    chunk.set_data(data.substr(begin, kChunk));
    if (!stream->Write(chunk)) break;
  }
  stream->WritesDone();
  return stream->Finish();
}

grpc::Status ServiceTest::upload(const std::string& patient, v1::ScanFormat format, const std::string& bytes,
                                 v1::Scan& scan) {
  scan = create_scan(patient, format, bytes);
  v1::Scan result;
  const grpc::Status status = send(scan, 0, bytes, result);
  if (status.ok()) scan = result;
  return status;
}

grpc::Status ServiceTest::build(const std::string& patient, const v1::ModelSpec& spec, v1::Operation& done) {
  v1::BuildModelRequest request;
  request.set_parent(patient);
  *request.mutable_spec() = spec;
  const grpc::Status status = call(*patients_, &v1::PatientService::Stub::BuildModel, request, done);
  while (status.ok() && !done.done()) {
    v1::WaitOperationRequest wait;
    wait.set_name(done.name());
    const grpc::Status waited = call(*operations_, &v1::OperationService::Stub::WaitOperation, wait, done);
    if (!waited.ok()) return waited;
  }
  return status;
}

v1::ModelSpec ServiceTest::square_spec() const {
  return parse_text<v1::ModelSpec>(R"(
    square { length_xi_mm: 40 length_eta_mm: 40 } n_xi: 8 n_eta: 8
    layers { name: "skin" thickness_mm { constant: 2 } youngs_modulus_kpa: 100 poisson_ratio: 0.45 density_kg_m3: 1100 }
    layers { name: "deep" thickness_mm { constant: 4 } youngs_modulus_kpa: 20 poisson_ratio: 0.45 density_kg_m3: 1000 })");
}

v1::Model ServiceTest::build_square(const std::string& patient) {
  v1::Operation operation;
  const grpc::Status status = build(patient, square_spec(), operation);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(operation.has_response()) << operation.error().message();
  v1::Model model;
  EXPECT_TRUE(operation.response().UnpackTo(&model));
  return model;
}

v1::SimulationSpec ServiceTest::square_plan(const std::string& model, double end_s) const {
  auto spec = parse_text<v1::SimulationSpec>(R"(
    films { name: "plane" below_layer: "skin" extent { xi_min: 0.125 xi_max: 0.875 eta_min: 0.125 eta_max: 0.875 }
      n_xi: 3 n_eta: 3 zones { name: "middle" box { xi_min: 0 xi_max: 1 eta_min: 0 eta_max: 1 } } }
    injections { zone: "middle" volume_ml: 0.05 rate_ml_per_s: 0.1 start_s: 0 }
    time { settle_skin_speed_mm_per_s: 0 }
    probes { name: "centre" place { chart { xi: 0.5 eta: 0.5 } } })");
  spec.set_model(model);
  spec.mutable_time()->set_end_s(end_s);
  return spec;
}

grpc::Status ServiceTest::create_simulation(const v1::SimulationSpec& spec, const std::string& id, bool start,
                                            v1::Simulation& simulation) {
  v1::CreateSimulationRequest request;
  request.set_simulation_id(id);
  *request.mutable_spec() = spec;
  request.set_start(start);
  return call(*simulations_, &v1::SimulationService::Stub::CreateSimulation, request, simulation);
}

v1::Simulation ServiceTest::get_simulation(const std::string& name) {
  v1::GetSimulationRequest request;
  request.set_name(name);
  v1::Simulation simulation;
  const grpc::Status status = call(*simulations_, &v1::SimulationService::Stub::GetSimulation, request, simulation);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return simulation;
}

v1::Simulation ServiceTest::await_end(const std::string& name) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(120);
  while (std::chrono::steady_clock::now() < deadline) {
    v1::Simulation simulation = get_simulation(name);
    if (has_ended(simulation.state()) || simulation.name().empty()) return simulation;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ADD_FAILURE() << name << " does not end";
  return {};
}

grpc::Status ServiceTest::call_raw(const std::string& method, const std::string& bytes) {
  grpc::GenericStub stub(channel_);
  Context context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(30));
  grpc::CompletionQueue queue;
  const auto wait = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    queue.Next(&tag, &ok);
  };
  auto stream = stub.PrepareCall(&context, method, &queue);
  stream->StartCall(nullptr);
  wait();
  const grpc::Slice slice(bytes);
  stream->WriteLast(grpc::ByteBuffer(&slice, 1), grpc::WriteOptions(), nullptr);
  wait();
  grpc::Status status;
  stream->Finish(&status, nullptr);
  wait();
  return status;
}

bool ServiceTest::is_serving() {
  grpc::GenericStub stub(channel_);
  Context context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(30));
  grpc::CompletionQueue queue;
  const grpc::Slice nothing;
  const grpc::ByteBuffer request(&nothing, 1);
  auto health = stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check", request, &queue);
  grpc::ByteBuffer response;
  grpc::Status status;
  health->StartCall();
  health->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  grpc::Slice slice;
  if (!status.ok() || !response.DumpToSingleSlice(&slice).ok()) return false;
  // HealthCheckResponse { status: SERVING }
  return std::string(reinterpret_cast<const char*>(slice.begin()), slice.size()) == "\x08\x01";
}

std::string ServiceTest::store_content() {
  std::string content;
  v1::ListPatientsResponse patients;
  EXPECT_TRUE(call(*patients_, &v1::PatientService::Stub::ListPatients, v1::ListPatientsRequest(), patients).ok());
  content += patients.DebugString();
  for (const v1::Patient& patient : patients.patients()) {
    v1::ListScansRequest scans_request;
    scans_request.set_parent(patient.name());
    v1::ListScansResponse scans;
    EXPECT_TRUE(call(*patients_, &v1::PatientService::Stub::ListScans, scans_request, scans).ok());
    v1::ListModelsRequest models_request;
    models_request.set_parent(patient.name());
    v1::ListModelsResponse models;
    EXPECT_TRUE(call(*patients_, &v1::PatientService::Stub::ListModels, models_request, models).ok());
    content += scans.DebugString() + models.DebugString();
  }
  v1::ListSimulationsResponse simulations;
  EXPECT_TRUE(
      call(*simulations_, &v1::SimulationService::Stub::ListSimulations, v1::ListSimulationsRequest(), simulations)
          .ok());
  content += simulations.DebugString();
  int files = 0;
  std::error_code ignored;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(directory_.path() / "data" / "scans", ignored)) {
    if (entry.is_regular_file()) ++files;
  }
  return content + std::to_string(files) + " files of scans\n";
}

std::string sheet_obj(int n, double height_mm) {
  std::ostringstream obj;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double x = 100.0 * i / (n - 1), y = 100.0 * j / (n - 1);
      obj << "v " << x << " " << y << " " << height_mm * std::sin(M_PI * x / 100.0) << "\n";
    }
  }
  for (int j = 0; j + 1 < n; ++j) {
    for (int i = 0; i + 1 < n; ++i) {
      const int a = j * n + i + 1;
      obj << "f " << a << " " << a + 1 << " " << a + n + 1 << "\nf " << a << " " << a + n + 1 << " " << a + n << "\n";
    }
  }
  return obj.str();
}

}  // namespace lipofill::testing
