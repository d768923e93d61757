// Answers that are asked for and never read, and requests that are larger in memory than on the
// wire: what each call of a caller keeps is bounded, for one and in all, and given back.

#include <thread>

#include "tests/integration/security/raw_http2.h"
#include "tests/integration/security/secure_fixture.h"
#include "tests/integration/service/footprint.h"

namespace lipofill::testing {
namespace {

using grpc::StatusCode;
using Clients = std::vector<std::unique_ptr<RawHttp2>>;

class UnreadTest : public SecureTest {
 protected:
  explicit UnreadTest(const std::vector<std::string>& arguments = {})
      : SecureTest(arguments), planner_(caller("ward", "planner")), own_(planner_, "ward") {
    before_mb_ = resident_mb();
  }

  int port() const { return std::stoi(daemon_->address().substr(daemon_->address().find(':') + 1)); }
  double resident_mb() const { return read_footprint(daemon_->pid()).resident_mb; }
  double grown_mb() const { return resident_mb() - before_mb_; }
  /// Somebody of the ward, by number.
  RawHttp2::Headers viewer(int number) const {
    nlohmann::json with = claims("ward", "viewer");
    with["sub"] = "viewer-" + std::to_string(number);
    return {{"authorization", "Bearer " + token(with)}};
  }
  /// A client without room for any answer, which makes so many calls.
  std::unique_ptr<RawHttp2> ask(const std::string& method, const std::string& message, int calls,
                                const RawHttp2::Headers& who) {
    auto client = std::make_unique<RawHttp2>(port(), 0);
    for (int call = 0; call < calls; ++call) {
      const auto stream = static_cast<uint32_t>(2 * call + 1);
      if (!client->send(RawHttp2::whole_call(stream, "/lipofill.v1." + method, message, who), 5.0)) break;
    }
    return client;
  }
  /// The number of calls that ended, for so long as one does within the time.
  static int ended(RawHttp2& client, double patience_s) {
    int n = 0;
    for (const SeenFrameHeader& frame : client.read_all(patience_s)) {
      n += (frame.flags & RawHttp2::kEndStream) != 0 || frame.type == FrameType::kResetStream ? 1 : 0;
    }
    return n;
  }
  bool others_are_served() {
    return caller("clinic", "planner").call_json("PatientService/ListPatients", "{}").status.ok();
  }
  /// Once its clients have left, what they asked for is given back.
  void expect_given_back(double most_mb) {
    for (int i = 0; i < 100 && grown_mb() > most_mb; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_LT(grown_mb(), most_mb) << "of clients that have left";
  }
  /// A model of the ward whose skin has so many quadrilaterals, and no tissue.
  std::string build_skin(int divisions) {
    const std::string n = std::to_string(divisions);
    const Answer answer = planner_.call_json(
        "PatientService/BuildModel", R"({"parent":")" + own_.patient +
                                         R"(","spec":{"square":{"lengthXiMm":40,"lengthEtaMm":40},)" + R"("nXi":)" + n +
                                         R"(,"nEta":)" + n + "}}");
    v1::Operation operation;
    EXPECT_TRUE(answer.status.ok() && operation.ParseFromString(answer.messages.at(0)))
        << answer.status.error_message();
    while (!operation.done()) {
      const Answer waited = planner_.call_json("OperationService/WaitOperation",
                                               R"({"name":")" + operation.name() + R"(","timeout":"5s"})");
      if (!waited.status.ok() || !operation.ParseFromString(waited.messages.at(0))) break;
    }
    v1::Model model;
    EXPECT_TRUE(operation.response().UnpackTo(&model)) << operation.error().message();
    return model.name();
  }

  const Caller planner_;
  const Possessions own_;
  double before_mb_ = 0.0;
};

TEST_F(UnreadTest, AnswersAreBounded) {
  const std::string label(60, 'n');
  for (int i = 0; i < 1000; ++i) {
    const std::string request = R"({"patientId":"ward-)" + std::to_string(i) + R"(","displayName":")" + label + "\"}";
    ASSERT_TRUE(planner_.call_json("PatientService/CreatePatient", request).status.ok());
  }
  before_mb_ = resident_mb();
  const std::string page("\x08\xe8\x07", 3);  // page_size: 1000
  Clients clients;
  int refused = 0;
  double most_mb = 0.0;
  for (int client = 0; client < 8; ++client) {
    clients.push_back(ask("PatientService/ListPatients", page, 250, viewer(client)));
    refused += ended(*clients.back(), 1.0);
    most_mb = std::max(most_mb, grown_mb());
  }
  EXPECT_GT(refused, 0) << "of 2,000 answers some are refused";
  // 67 MB of answers, a header and a stream for each, and what waits for the next sweep.
  EXPECT_LT(most_mb, 130.0);
  EXPECT_TRUE(others_are_served()) << "it is nobody else's bound";
  clients.clear();
  expect_given_back(40.0);
}

TEST_F(UnreadTest, MeshesAreBounded) {
  const std::string model = build_skin(440);  // 12 MB of points and cells
  before_mb_ = resident_mb();
  v1::DownloadModelMeshRequest request;
  request.set_name(model);
  Clients clients;
  double most_mb = 0.0;
  for (int client = 0; client < 3; ++client) {
    clients.push_back(ask("PatientService/DownloadModelMesh", request.SerializeAsString(), 40, viewer(client)));
    EXPECT_GT(ended(*clients.back(), 2.0), 30) << "a caller has room for two";
    most_mb = std::max(most_mb, grown_mb());
  }
  EXPECT_LT(most_mb, 200.0) << "three callers have 24 MB each, and two are being made";
  EXPECT_TRUE(others_are_served());
  clients.clear();
  expect_given_back(60.0);
}

TEST_F(UnreadTest, DecksSeriesAndShapesAreBounded) {
  v1::ExportTissueDeckRequest deck;
  deck.set_name(own_.simulation);
  v1::GetSeriesRequest series;
  series.set_name(own_.simulation);
  v1::FindShapeRequest shape;
  shape.set_simulation(own_.simulation);
  shape.set_drag("d");
  const std::vector<std::pair<std::string, std::string>> calls = {
      {"SimulationService/ExportTissueDeck", deck.SerializeAsString()},
      {"SimulationService/GetSeries", series.SerializeAsString()},
      {"SimulationService/FindShape", shape.SerializeAsString()},
  };
  for (const auto& [method, message] : calls) {
    Clients clients;
    for (int client = 0; client < 4; ++client) clients.push_back(ask(method, message, 250, viewer(client)));
    for (const auto& client : clients) ended(*client, 1.0);
    EXPECT_LT(grown_mb(), 130.0) << method;
    EXPECT_TRUE(others_are_served()) << method;
  }
  expect_given_back(60.0);
}

TEST_F(UnreadTest, ARequestCountsByWhatItTakesInMemory) {
  // Two million injections of which nothing is said have 4 MB on the wire, and take some 200.
  v1::CheckPlanRequest request;
  for (int i = 0; i < 1'900'000; ++i) request.mutable_spec()->add_injections();
  const std::string bytes = request.SerializeAsString();
  request.Clear();
  for (int k = 0; k < 4; ++k) {
    const Answer answer = caller("ward", "viewer").call_bytes("SimulationService/CheckPlan", bytes);
    EXPECT_EQ(answer.code(), StatusCode::RESOURCE_EXHAUSTED) << answer.status.error_message();
    EXPECT_EQ(answer.reason(), "TOO_MANY_BYTES");
  }
  expect_given_back(40.0);
}

class UnreadFramesTest : public UnreadTest {
 protected:
  UnreadFramesTest() : UnreadTest({"--viewer-memory-mb", "64"}) {}
};

TEST_F(UnreadFramesTest, SelectionsOfAResultAreBounded) {
  const std::string model = build_skin(440);
  const std::string plan = R"("films":[{"name":"wide","nXi":4,"nEta":4,
      "zones":[{"name":"all","box":{"xiMin":0,"xiMax":1,"etaMin":0,"etaMax":1}}],
      "wall":{"kind":"WINKLER","stiffnessKpaPerMm":10}}],
    "injections":[{"zone":"all","volumeMl":0.1,"rateMlPerS":0.1,"startS":0}],
    "time":{"settleSkinSpeedMmPerS":0,"endS":0.01})";
  const Answer created =
      planner_.call_json("SimulationService/CreateSimulation",
                         R"({"simulationId":"ward-w","start":true,"spec":{"model":")" + model + R"(",)" + plan + "}}");
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  v1::Simulation simulation;
  do {
    const Answer looked = planner_.call_json("SimulationService/GetSimulation", R"({"name":"simulations/ward-w"})");
    ASSERT_TRUE(looked.status.ok() && simulation.ParseFromString(looked.messages.at(0)));
  } while (simulation.state() == v1::Simulation::RUNNING || simulation.state() == v1::Simulation::QUEUED);
  before_mb_ = resident_mb();
  // Each is another selection of fields of the skin, which comes with its mesh.
  const std::vector<std::string> fields = {"skin.displacement", "film/wide.pressure", "film/wide.thickness"};
  Clients clients;
  double most_mb = 0.0;
  for (int selection = 0; selection < 24; ++selection) {
    v1::WatchRequest request;
    request.set_simulation("simulations/ward-w");
    request.add_fields(fields[0]);
    if ((selection & 1) != 0) request.add_fields(fields[1]);
    if ((selection & 2) != 0) request.add_fields(fields[2]);
    if ((selection & 4) != 0) request.set_field_type(v1::UINT16);
    for (int again = 0; again < selection / 8; ++again) request.add_fields(fields[0]);
    clients.push_back(ask("FrameService/Watch", request.SerializeAsString(), 1, viewer(selection)));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    most_mb = std::max(most_mb, grown_mb());
  }
  int refused = 0;
  for (const auto& client : clients) refused += ended(*client, 0.2);
  EXPECT_GT(refused, 0);
  EXPECT_LT(most_mb, 160.0);
  EXPECT_TRUE(others_are_served());
  clients.clear();
  expect_given_back(60.0);
}

}  // namespace
}  // namespace lipofill::testing
