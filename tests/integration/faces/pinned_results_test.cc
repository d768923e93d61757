// The results of the sample plans, pinned: the hash of the state that each ends in, by the real
// daemon. They are the same on every x86-64-v3 processor. `deploy/pin` writes pinned_results.json
// anew; the CHANGELOG says when and why.

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "core/base/hash.h"
#include "tests/integration/cli/cli_fixture.h"
#include "tests/integration/service/daemon_process.h"

namespace lipofill::testing {
namespace {

using nlohmann::json;

const json& pinned() {
  static const json results = json::parse(std::ifstream(LIPOFILL_PINNED_RESULTS));
  return results;
}

/// Notes a result in the file that `deploy/pin` names, where it asks for that.
void note(const std::string& plan, const std::string& way, const std::string& hash) {
  const char* file = std::getenv("LIPOFILL_PIN_TO");
  if (file == nullptr) return;
  json results = json::object();
  if (std::ifstream before(file); before) results = json::parse(before);
  results[plan][way] = hash;
  std::ofstream(file) << results.dump(2) << "\n";
}

void expect_pinned(const std::string& plan, const std::string& way, const std::string& hash) {
  note(plan, way, hash);
  EXPECT_EQ(json(hash), pinned().value(json::json_pointer("/" + plan + "/" + way), json()))
      << plan << " (" << way << ") ends in other bytes than before. If that is meant, run deploy/pin and say why in "
      << "the CHANGELOG.";
}

class PinnedPlan : public CliTest, public ::testing::WithParamInterface<std::string> {
 protected:
  static std::string path_of(const std::string& plan) { return std::string(LIPOFILL_PLANS "/") + plan + ".json"; }

  /// The summary of a run with more options, in an environment.
  json summary_of(const std::string& plan, const std::string& options, const std::string& environment = "") const {
    return answer_of("env " + environment + " lipofill run " + path_of(plan) + " --out out" + options +
                     " --spawn --discard --quiet --no-picture");
  }
};

TEST_P(PinnedPlan, EndsInTheSameBytesAsItIs) {
  const json summary = summary_of(GetParam(), "");
  EXPECT_EQ(summary.at("state"), "SETTLED");
  expect_pinned(GetParam(), "settled", summary.at("state_hash"));
}

TEST_P(PinnedPlan, EndsInTheSameBytesFast) {
  const json summary = summary_of(GetParam(), " --fast");
  EXPECT_EQ(summary.at("state"), "SETTLED");
  expect_pinned(GetParam(), "fast", summary.at("state_hash"));
}

INSTANTIATE_TEST_SUITE_P(Every, PinnedPlan,
                         ::testing::Values("square", "jaw_angle", "elastography", "two_planes", "ligaments",
                                           "coleman_fat"),
                         [](const auto& plan) { return plan.param; });

using PinnedWays = PinnedPlan;

TEST_F(PinnedWays, APreviewIsTheSame) {
  summary_of("jaw_angle", " --preview");
  Hasher hasher;
  hasher.add(std::string_view(read("out/skin_preview.vtp")));
  expect_pinned("jaw_angle", "preview_skin", hasher.hex_digest());
}

TEST_F(PinnedWays, ARestoredSimulationEndsAsTheOneThatWasNeverInterrupted) {
  DaemonProcess daemon((folder_ / "data").string());
  const auto ask = [&](const std::string& command) {
    return answer_of("env LIPOFILL_SERVER=" + daemon.address() + " lipofill " + command);
  };
  const std::string plan = path_of("jaw_angle");
  ask("patient create --id p");
  const std::string model = ask("model build p " + plan)["name"];
  ask("simulation create " + plan + " --id s --start --model " + model);
  const auto steps = [&] { return std::stoi(ask("simulation get s")["summary"]["steps"].get<std::string>()); };
  for (int tries = 0; tries < 200 && steps() < 10; ++tries) continue;
  ask("simulation checkpoint s --id midway");
  ask("simulation restore simulations/s/checkpoints/midway --new --id t --start");
  json restored = ask("simulation get t");
  for (int tries = 0; tries < 600 && restored["state"] == "RUNNING"; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    restored = ask("simulation get t");
  }
  EXPECT_EQ(restored["state"], "SETTLED");
  expect_pinned("jaw_angle", "restored", restored["summary"]["state_hash"]);
  EXPECT_EQ(pinned()["jaw_angle"]["restored"], pinned()["jaw_angle"]["settled"]);
}

/// Kernels that OpenBLAS would take on other processors; what this one cannot run, OpenBLAS itself
/// would refuse or replace, and the pinned family comes before that.
TEST_F(PinnedWays, TheKernelsThatOpenBlasWouldChooseDoNotMatter) {
  for (const char* family : {"Prescott", "Nehalem", "Sandybridge", "Haswell", "Zen", "SkylakeX", "Cooperlake"}) {
    SCOPED_TRACE(family);
    const json summary = summary_of("jaw_angle", " --fast", std::string("OPENBLAS_CORETYPE=") + family);
    expect_pinned("jaw_angle", "fast", summary.at("state_hash"));
  }
}

}  // namespace
}  // namespace lipofill::testing
