#include "tests/integration/security/secure_fixture.h"

#include <fstream>
#include <sstream>

#include "google/rpc/status.pb.h"

namespace lipofill::testing {
namespace {

template <typename Response>
Response expect_answer(const Answer& answer) {
  Response response;
  EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
  EXPECT_TRUE(answer.messages.size() == 1 && response.ParseFromString(answer.messages[0]));
  return response;
}

constexpr char kModelSpec[] = R"({"square":{"lengthXiMm":40,"lengthEtaMm":40},"nXi":8,"nEta":8,
  "layers":[{"name":"skin","thicknessMm":{"constant":2},"youngsModulusKpa":100,"poissonRatio":0.45,"densityKgM3":1100},
            {"name":"deep","thicknessMm":{"constant":4},"youngsModulusKpa":20,"poissonRatio":0.45,"densityKgM3":1000}]})";
constexpr char kPlan[] = R"("films":[{"name":"plane","belowLayer":"skin","nXi":3,"nEta":3,
    "extent":{"xiMin":0.125,"xiMax":0.875,"etaMin":0.125,"etaMax":0.875},
    "zones":[{"name":"middle","box":{"xiMin":0,"xiMax":1,"etaMin":0,"etaMax":1}}]}],
  "injections":[{"zone":"middle","volumeMl":0.05,"rateMlPerS":0.1,"startS":0}],
  "time":{"endS":1000,"settleSkinSpeedMmPerS":0})";

}  // namespace

std::string read_whole_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

SecureTest::SecureTest(const std::vector<std::string>& arguments) {
  const std::string keys = directory_.file("keys.pem");
  std::ofstream(keys) << key_.public_pem();
  arguments_ = {"--token-keys-file", keys,       "--token-issuer",       "https://id.example",
                "--token-audience",  "lipofill", "--token-clock-skew-s", "0"};
  start(arguments);
}

void SecureTest::start(const std::vector<std::string>& arguments) {
  std::vector<std::string> all = arguments_;
  all.insert(all.end(), arguments.begin(), arguments.end());
  daemon_.reset();  // one at a time has the data
  daemon_ = std::make_unique<DaemonProcess>(directory_.file("data"), all);
  channel_ = grpc::CreateChannel(daemon_->address(), grpc::InsecureChannelCredentials());
}

nlohmann::json SecureTest::claims(const std::string& tenant, const std::string& role) {
  nlohmann::json claims = good_claims();
  claims["sub"] = role + "-of-" + tenant;
  claims["tenant"] = tenant;
  claims["roles"] = {role};
  return claims;
}

Caller SecureTest::caller(const std::string& tenant, const std::string& role,
                          const std::vector<std::string>& patients) {
  nlohmann::json with = claims(tenant, role);
  if (!patients.empty()) with["patients"] = patients;
  return bearer(token(with));
}

Possessions::Possessions(const Caller& owner, const std::string& tenant) {
  const std::string id = tenant + "-a";
  patient = expect_answer<v1::Patient>(owner.call_json("PatientService/CreatePatient",
                                                       R"({"patientId":")" + id + R"(","displayName":"secret-name"})"))
                .name();
  const std::string sha(64, 'a');
  scan = expect_answer<v1::Scan>(owner.call_json("PatientService/CreateScan",
                                                 R"({"parent":")" + patient +
                                                     R"(","format":"OBJ","sizeBytes":"9","sha256":")" + sha + "\"}"))
             .name();
  auto built = expect_answer<v1::Operation>(
      owner.call_json("PatientService/BuildModel", R"({"parent":")" + patient + R"(","spec":)" + kModelSpec + "}"));
  operation = built.name();
  while (!built.done() && !operation.empty()) {
    built = expect_answer<v1::Operation>(
        owner.call_json("OperationService/WaitOperation", R"({"name":")" + operation + R"(","timeout":"5s"})"));
  }
  EXPECT_FALSE(built.has_error()) << built.error().message();
  v1::Model made;
  built.response().UnpackTo(&made);
  model = made.name();
  plan = expect_answer<v1::SavedPlan>(
             owner.call_json("PlanService/CreatePlan", R"({"parent":")" + patient + R"(","planId":"q"})"))
             .name();
  simulation =
      expect_answer<v1::Simulation>(owner.call_json("SimulationService/CreateSimulation",
                                                    R"({"simulationId":")" + tenant + R"(-x","spec":{"model":")" +
                                                        model + R"(",)" + kPlan + "}}"))
          .name();
  checkpoint =
      expect_answer<v1::Checkpoint>(owner.call_json("SimulationService/CreateCheckpoint",
                                                    R"({"parent":")" + simulation + R"(","checkpointId":"c"})"))
          .name();
}

}  // namespace lipofill::testing
