#include "client/cpp/plan_file.h"

#include <gmock/gmock.h>

#include "client/cpp/errors.h"
#include "temporary_folder.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

class PlanFileTest : public TemporaryFolderTest {
 protected:
  std::string refusal_of(const std::string& text) const {
    const auto plan = load_plan(write("plan.json", text));
    EXPECT_EQ(plan.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(error_text(plan.status()), HasSubstr("plan.json"));
    return error_text(plan.status());
  }
};

TEST_F(PlanFileTest, ReadsBothSpellingsAndNamesFilesBesideThePlan) {
  const auto plan = load_plan(write("plan.json", R"({
    "name": "jaw", "scan": {"file": "faces/a.obj", "landmarks_file": "faces/a.json#before", "unit": "CENTIMETRE"},
    "simulation": {"fat": {"viscosity_pa_s": 12}, "coupling": "LUMPED",
                   "films": [{"name": "deep", "restThicknessMm": {"constant": 0.1}}]}})"));
  ASSERT_TRUE(plan.ok()) << plan.status();
  EXPECT_EQ(plan->plan.name(), "jaw");
  EXPECT_EQ(plan->plan.scan().unit(), v1::CENTIMETRE);
  EXPECT_EQ(plan->plan.simulation().fat().viscosity_pa_s(), 12.0);
  EXPECT_EQ(plan->plan.simulation().films(0).rest_thickness_mm().constant(), 0.1);
  EXPECT_EQ(*plan->scan_file, folder_ / "faces/a.obj");
  EXPECT_EQ(*plan->landmarks_file, (folder_ / "faces/a.json#before").string());
}

TEST_F(PlanFileTest, NamesABoneBesideThePlan) {
  const auto plan = load_plan(write("plan.json", R"({"model": {"scan_region": {}},
    "scan": {"file": "skin.ply"}, "bone": {"file": "faces/bone.ply", "unit": "METRE"}})"));
  ASSERT_TRUE(plan.ok()) << plan.status();
  EXPECT_EQ(*plan->bone_file, folder_ / "faces/bone.ply");
  EXPECT_EQ(plan->plan.bone().unit(), v1::METRE);
  EXPECT_TRUE(check_bone_file(*plan).ok());
}

TEST_F(PlanFileTest, RefusesABoneWithoutASkinOrWithLandmarks) {
  const auto plan = load_plan(write("plan.json", R"({"model": {"square": {}},
    "bone": {"file": "bone.ply", "landmarks_file": "bone.json"}})"));
  ASSERT_TRUE(plan.ok()) << plan.status();
  const auto violations = error_details_of(check_bone_file(*plan)).violations;
  ASSERT_EQ(violations.size(), 2u);
  EXPECT_EQ(violations[0].field, "bone.landmarks_file");
  EXPECT_EQ(violations[1].field, "bone.file");
}

TEST_F(PlanFileTest, SaysWhichNamesThereAreForOneThatThereIsNot) {
  const auto plan = load_plan(write("plan.json", R"({"simulation": {"fat": {"preset": "COLEMANN"}, "coupling": 2,
      "time": {"goal": "SETTLED_SHAPE"}}})"));
  const auto violations = error_details_of(plan.status()).violations;
  ASSERT_EQ(violations.size(), 1u);
  EXPECT_EQ(violations[0].field, "simulation.fat.preset");
  EXPECT_THAT(violations[0].description,
              HasSubstr("is \"COLEMANN\", must be one of NEWTONIAN, COLEMAN, NANOFAT, SVF_GEL (in "));
}

TEST_F(PlanFileTest, NamesEveryUnknownFieldWithItsPathAndTheNearestName) {
  const auto plan =
      load_plan(write("plan.json", R"({"simulation": {"injections": [{"zone": "a"}, {"volume": 3}], "viscosity": 2},
      "model": {"scan_region": {"landmarks_mm": {"nasion": {"x": 1, "w": 2}}}}, "zzz": 1})"));
  const auto violations = error_details_of(plan.status()).violations;
  ASSERT_EQ(violations.size(), 4u);
  EXPECT_EQ(violations[0].field, "model.scan_region.landmarks_mm[nasion].w");
  EXPECT_EQ(violations[1].field, "simulation.injections[1].volume");
  EXPECT_THAT(violations[1].description, HasSubstr("did you mean volume_ml?"));
  EXPECT_EQ(violations[2].field, "simulation.viscosity");
  EXPECT_EQ(violations[3].field, "zzz");
  EXPECT_THAT(violations[3].description,
              HasSubstr("Plan has name, description, scan, model, simulation, output, bone"));
  EXPECT_THAT(violations[3].description, HasSubstr("plan.json"));
}

TEST_F(PlanFileTest, SaysWhereTheJsonEnds) {
  EXPECT_THAT(refusal_of("{\n  \"name\": \"a\",\n"), HasSubstr("line 3"));
  EXPECT_THAT(refusal_of("[]"), HasSubstr("not a JSON object"));
  EXPECT_THAT(refusal_of(""), HasSubstr("not JSON"));
  EXPECT_THAT(refusal_of(std::string("\x7f"
                                     "ELF\0\1\2",
                                     7)),
              HasSubstr("not JSON"));
  EXPECT_THAT(refusal_of(R"({"simulation": {"coupling": "SOMEHOW"}})"), HasSubstr("SOMEHOW"));
  EXPECT_THAT(refusal_of(R"({"model": {"n_xi": "many"}})"), HasSubstr("many"));
  EXPECT_THAT(refusal_of(std::string(100'000, '[')), HasSubstr("not JSON"));
  EXPECT_THAT(std::string(load_plan(folder_ / "nowhere.json").status().message()), HasSubstr("does not exist"));
}

TEST_F(PlanFileTest, LandmarksGoIntoTheRegion) {
  write("a.json",
        R"({"landmarks": {"nasion": [1, 2, 3]}, "axes": {"left": [1,0,0], "up": [0,1,0], "forward": [0,0,1]}})");
  auto plan = load_plan(
      write("plan.json", R"({"scan": {"file": "a.obj", "landmarks_file": "a.json"}, "model": {"scan_region": {}}})"));
  ASSERT_TRUE(plan.ok());
  ASSERT_TRUE(load_plan_landmarks(&*plan).ok());
  const v1::ScanRegion& region = plan->plan.model().scan_region();
  EXPECT_EQ(region.landmarks_mm().at("nasion").y(), 2.0);
  EXPECT_EQ(region.axes().forward().z(), 1.0);

  auto square = load_plan(write("square.json", R"({"scan": {"landmarks_file": "a.json"}, "model": {"square": {}}})"));
  ASSERT_TRUE(square.ok());
  EXPECT_EQ(error_details_of(load_plan_landmarks(&*square)).violations.at(0).field, "scan.landmarks_file");
}

TEST(DisplayName, IsWhatTheDaemonTakes) {
  EXPECT_EQ(display_name_of("Jaw_angle 2"), "jaw-angle-2");
  EXPECT_EQ(display_name_of(std::string(100, 'A')), std::string(63, 'a'));
}

}  // namespace
}  // namespace lipofill::client
