// Plans of several parts of a face: parts that touch are simulated together, the others side by
// side, each to the same shape as in a plan of its own.

#include <fstream>

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class SeveralPartsTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    const std::filesystem::path plans = LIPOFILL_PLANS;
    face_ = json::parse(std::ifstream(plans / "several_parts.json"));
    for (const char* name : {"file", "landmarks_file"}) {
      face_["scan"][name] = (plans / face_["scan"][name].get<std::string>()).string();
    }
    // Two layers in place of four: the parts lie as they do.
    face_["model"]["layers"] = {{{"name", "skin"}}, {{"name", "muscle"}, {"thickness_mm", {{"constant", 6}}}}};
    for (json& part : face_["parts"]) part["simulation"]["films"][0]["below_layer"] = "skin";
  }
  /// One part as a plan of its own.
  json plan_of(size_t part) const {
    json plan = face_;
    plan.erase("parts");
    plan["simulation"].update(face_["parts"][part]["simulation"]);
    return plan;
  }
  json run_plan(const json& plan, const std::string& out) {
    write("plan.json", plan.dump());
    return answer_of("lipofill run plan.json --out " + out + " --spawn --discard --quiet --no-picture --json");
  }

  json face_;
};

TEST_F(SeveralPartsTest, RunSideBySideToTheShapesOfTheirOwnPlans) {
  face_["parts"].erase(1);
  const json face = run_plan(face_, "face");
  EXPECT_EQ(face.at("state"), "SETTLED");
  EXPECT_NEAR(face.at("injected_ml").get<double>(), 3.5, 1e-9);
  ASSERT_EQ(face.at("parts").size(), 2u) << "temple and jaw do not touch";
  EXPECT_EQ(face.at("zones").size(), 2u);
  for (size_t k = 0; k < 2; ++k) {
    const json& part = face.at("parts")[k];
    EXPECT_EQ(part.at("state_hash"), run_plan(plan_of(k), "alone").at("state_hash")) << part.at("plan");
    EXPECT_TRUE(exists("face/" + part.at("plan").get<std::string>() + "/skin_0000.vtp"));
  }
  EXPECT_TRUE(exists("face/scan_0000.vtp"));
  EXPECT_EQ(read_json("face/summary.json"), face);
}

TEST_F(SeveralPartsTest, RunTogetherWhereTheyTouch) {
  face_["parts"].erase(2);
  const json face = run_plan(face_, "face");
  EXPECT_EQ(face.at("state"), "SETTLED");
  ASSERT_EQ(face.at("parts").size(), 1u);
  EXPECT_EQ(face.at("parts")[0].at("plan"), "temple-and-cheekbone");
  EXPECT_THAT(face.at("parts")[0].at("of"), ElementsAre("temple", "cheekbone"));
  json together = plan_of(0);
  together["simulation"]["films"][0]["zones"].push_back(face_["parts"][1]["simulation"]["films"][0]["zones"][0]);
  together["simulation"]["injections"].push_back(face_["parts"][1]["simulation"]["injections"][0]);
  together["simulation"]["time"]["end_s"] = 240;
  EXPECT_EQ(face.at("parts")[0].at("state_hash"), run_plan(together, "together").at("state_hash"));
}

TEST_F(SeveralPartsTest, AreRefusedInWordsThatNameThePart) {
  json wrong = face_;
  wrong["parts"][2]["simulation"]["films"][0]["zones"][0]["region"] = "elbow_left";
  write("plan.json", wrong.dump());
  const CommandResult region = run("lipofill run plan.json --out face --spawn --quiet");
  EXPECT_EQ(region.exit_code, 2);
  EXPECT_THAT(region.errors, HasSubstr("part 'jaw'"));
  EXPECT_THAT(region.errors, HasSubstr("elbow_left"));

  wrong = face_;
  wrong["parts"][0].erase("name");
  write("plan.json", wrong.dump());
  EXPECT_THAT(run("lipofill run plan.json --out face --spawn --quiet").errors, HasSubstr("name: is missing"));

  wrong = face_;
  wrong["parts"][0]["name"] = wrong["parts"][2]["name"];
  write("plan.json", wrong.dump());
  EXPECT_THAT(run("lipofill run plan.json --out face --spawn --quiet").errors, HasSubstr("is 'jaw' again"));

  write("plan.json", face_.dump());
  const CommandResult option = run("lipofill run plan.json --out face --spawn --quiet --preview");
  EXPECT_EQ(option.exit_code, 2);
  EXPECT_THAT(option.errors, HasSubstr("--preview: is not for a plan of several parts"));
}

}  // namespace
}  // namespace lipofill::testing
