// Calls whose caller has left end early, and those that wait are not begun: nobody computes for
// nobody.

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/integration/service/service_fixture.h"

namespace lipofill::testing {
namespace {

using std::chrono::duration;

constexpr char kEvaluate[] = "/lipofill.v1.SimulationService/EvaluateSimulation";

class DepartedCallersTest : public ServiceTest {
 protected:
  DepartedCallersTest() : ServiceTest({"--log-format", "json"}) {
    create_patient();
    v1::ModelSpec fine = square_spec();
    fine.mutable_square()->set_length_xi_mm(100);
    fine.mutable_square()->set_length_eta_mm(100);
    fine.set_n_xi(64);
    fine.set_n_eta(64);
    v1::Operation operation;
    v1::Model model;
    EXPECT_TRUE(build("patients/anna", fine, operation).ok());
    EXPECT_TRUE(operation.response().UnpackTo(&model));
    v1::Simulation simulation;
    EXPECT_TRUE(create_simulation(square_plan(model.name(), 1.0), "x", false, simulation).ok());
    v1::Scan target;
    EXPECT_TRUE(upload("patients/anna", v1::OBJ, sheet_obj(160), target).ok());
    request_.set_name("simulations/x");
    request_.set_target_scan(target.name());
  }

  /// Lets an evaluation go on for so long, and leaves.
  grpc::Status evaluate(duration<double> patience) {
    Context context;
    context.set_deadline(std::chrono::system_clock::now() +
                         std::chrono::duration_cast<std::chrono::milliseconds>(patience));
    v1::Evaluation evaluation;
    return simulations_->EvaluateSimulation(&context, request_, &evaluation);
  }
  /// How calls ended on the side of the daemon, once so many have.
  std::vector<std::string> await_codes(size_t n) {
    std::vector<std::string> codes;
    for (int i = 0; i < 6000 && codes.size() < n; ++i) {
      codes.clear();
      std::istringstream log(daemon_->log());
      for (std::string line; std::getline(log, line);) {
        const auto object = nlohmann::json::parse(line, nullptr, false);
        if (object.is_object() && object.value("method", "") == kEvaluate) codes.push_back(object["code"]);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_EQ(codes.size(), n);
    return codes;
  }
  duration<double> time_whole_evaluation() {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_TRUE(evaluate(std::chrono::seconds(120)).ok());
    return std::chrono::steady_clock::now() - begin;
  }

  v1::EvaluateSimulationRequest request_;
};

TEST_F(DepartedCallersTest, AnEvaluationEndsWithTheDeadlineOfItsCaller) {
  duration<double> patience = time_whole_evaluation() / 2;
  std::vector<std::string> codes = await_codes(1);
  EXPECT_EQ(codes.back(), "OK");
  // The machine may have been busy with something else before: then it is done in half the time.
  for (int i = 0; i < 5 && codes.back() == "OK"; ++i, patience /= 2) {
    evaluate(patience);
    codes = await_codes(codes.size() + 1);
  }
  EXPECT_EQ(codes.back(), "CANCELLED");
}

TEST_F(DepartedCallersTest, ThoseThatWaitAreNotBegun) {
  constexpr size_t kCallers = 12;
  const duration<double> patience = time_whole_evaluation() / 2;
  {
    std::vector<std::jthread> callers;
    for (size_t i = 0; i < kCallers; ++i) callers.emplace_back([&] { evaluate(patience); });
  }
  const std::vector<std::string> codes = await_codes(1 + kCallers);
  // Two are carried out at a time, and a few may have been done faster than the first.
  EXPECT_GE(std::count(codes.begin(), codes.end(), "CANCELLED"), static_cast<ptrdiff_t>(kCallers / 2));
  EXPECT_TRUE(evaluate(std::chrono::seconds(120)).ok()) << "others are served";
}

}  // namespace
}  // namespace lipofill::testing
