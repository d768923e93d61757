// The head CT of Debian's invesalius-examples: its skin and its bone extracted, and muscle down to
// the bone between them.

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include "tests/integration/cli/cli_fixture.h"
#include "tests/integration/service/daemon_process.h"

namespace lipofill::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::Gt;
using ::testing::Lt;

constexpr const char* kCranium = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";

class CtBoneTest : public CliTest {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kCranium)) GTEST_SKIP() << "no head CT: install Debian's invesalius-examples";
    CliTest::SetUp();
    daemon_ = std::make_unique<DaemonProcess>((folder_ / "data").string());
  }
  json ask(const std::string& command) const {
    return answer_of("env LIPOFILL_SERVER=" + daemon_->address() + " lipofill " + command);
  }

  /// The sample plan of the cheek, its layers thinner on top and the muscle down to the bone.
  void write_bone_plan() const {
    json plan = json::parse(std::ifstream(LIPOFILL_PLANS "/ct_cheek.json"));
    plan["scan"] = {{"file", "skin.ply"}, {"landmarks_file", "ct_cheek.landmarks.json"}};
    std::filesystem::copy(LIPOFILL_PLANS "/ct_cheek.landmarks.json", folder_ / "ct_cheek.landmarks.json");
    plan["bone"] = {{"file", "bone.ply"}};
    plan["model"]["tissue_preset"] = "ELASTOGRAPHY";
    plan["model"]["layers"] = {{{"name", "skin"}},
                               {{"name", "subcutaneous"}, {"thickness_mm", {{"constant", 2.0}}}},
                               {{"name", "muscle"}, {"down_to_bone", {{"max_thickness_mm", 25}, {"smoothing_mm", 6}}}}};
    write("plan.json", plan.dump());
  }

  std::unique_ptr<DaemonProcess> daemon_;
};

double number(const json& from, const char* name) {
  return from.at(name).get<double>();
}

TEST_F(CtBoneTest, MuscleFillsTheCheekDownToTheBone) {
  answer_of("lipofill scan convert " + std::string(kCranium) + " --out head.mha");
  answer_of("lipofill scan extract head.mha --isovalue -300 --smooth 15 --triangles 150000 --out skin.ply");
  const json bone = answer_of("lipofill scan extract head.mha --isovalue 250 --all --smooth 15 --out bone.ply");
  EXPECT_GT(number(bone, "triangles"), 1e5);
  write_bone_plan();
  ask("patient create --id p");
  const json model = ask("model build p plan.json");
  const json& found = model.at("report").at("bone");
  std::cout << model.at("report").at("layers").dump() << "\n" << found.dump() << "\n";
  EXPECT_GT(number(found, "measured_share"), 0.8);
  // Over the cheek bone and its arch there are 8 to 10 mm of soft tissue, beside the teeth some 25.
  EXPECT_THAT(number(found, "min_depth_mm"), AllOf(Gt(4.0), Lt(11.0)));
  EXPECT_THAT(number(found, "mean_depth_mm"), AllOf(Gt(9.0), Lt(30.0)));
  const json& muscle = model.at("report").at("layers")[2];
  EXPECT_NEAR(number(muscle, "min_thickness_mm"), number(found, "min_depth_mm") - 3.8, 1e-6);
  EXPECT_LE(number(muscle, "max_thickness_mm"), 25.0 + 1e-9);
  EXPECT_GT(number(model.at("report"), "min_scaled_jacobian"), 0.1);
}

}  // namespace
}  // namespace lipofill::testing
