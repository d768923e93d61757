// What is another's is answered as fast as what is not there. The clock is not asked how fast: the
// calls take turns, and the ranks of their times must not tell the two apart. What else the machine
// does blurs the ranks, and makes nobody fail.

#include <algorithm>
#include <chrono>
#include <functional>
#include <random>

#include "tests/integration/security/secure_fixture.h"

namespace lipofill::testing {
namespace {

using Clock = std::chrono::steady_clock;
using grpc::StatusCode;

/// The chance that one of `a` is larger than one of `b` (Mann and Whitney's U over its maximum): a
/// half where both have the same distribution, with a deviation of 1 / sqrt(6 n).
double chance_of_larger(std::vector<double> a, std::vector<double> b) {
  std::sort(b.begin(), b.end());
  double larger = 0.0;
  for (const double value : a) {
    larger += static_cast<double>(std::lower_bound(b.begin(), b.end(), value) - b.begin());
  }
  return larger / static_cast<double>(a.size() * b.size());
}

class TimingTest : public SecureTest {
 protected:
  TimingTest() : wards_(caller("ward", "planner"), "ward"), stranger_(caller("clinic", "admin")) {}

  double time_of(const std::string& method, const std::string& name) {
    const Clock::time_point begin = Clock::now();
    const Answer answer = stranger_.call_json(method, R"({"name":")" + name + "\"}");
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    EXPECT_EQ(answer.code(), StatusCode::NOT_FOUND) << method << " " << name;
    return seconds;
  }
  /// Eight deviations.
  void expect_alike(const std::string& method, const std::string& others, const std::string& absent) {
    constexpr int kCalls = 400;
    constexpr double kWithin = 0.165;
    std::vector<double> of_others, of_absent;
    std::mt19937 random(7);
    for (int k = 0; k < kCalls; ++k) {
      const bool others_first = random() % 2 == 0;
      if (others_first) of_others.push_back(time_of(method, others));
      of_absent.push_back(time_of(method, absent));
      if (!others_first) of_others.push_back(time_of(method, others));
    }
    EXPECT_NEAR(chance_of_larger(of_others, of_absent), 0.5, kWithin) << method << ", " << others;
  }

  const Possessions wards_;
  const Caller stranger_;
};

TEST_F(TimingTest, WhatIsAnothersTakesAsLongAsWhatIsNotThere) {
  expect_alike("PatientService/GetPatient", wards_.patient, "patients/ward-none");
  expect_alike("PatientService/GetModel", wards_.model, wards_.patient + "/models/none");
  expect_alike("OperationService/GetOperation", wards_.operation, "operations/none");
  for (const char* method : {"GetSimulation", "DeleteSimulation", "PauseSimulation", "GetSeries"}) {
    expect_alike(std::string("SimulationService/") + method, wards_.simulation, "simulations/ward-none");
  }
}

TEST_F(TimingTest, TheRanksTellWhatTakesLonger) {
  std::vector<double> a, b;
  for (int k = 0; k < 100; ++k) {
    a.push_back(k + 200.0);
    b.push_back(k);
  }
  EXPECT_EQ(chance_of_larger(a, b), 1.0);
  EXPECT_EQ(chance_of_larger(b, a), 0.0);
  EXPECT_NEAR(chance_of_larger(b, b), 0.5, 0.01);
}

}  // namespace
}  // namespace lipofill::testing
