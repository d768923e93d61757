// The sample plan of the jaw from scan to result, by one command, on the shipped face and on real
// scans. The plan's landmarks carry it from one face to another.

#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::Lt;

constexpr const char* kJawAngle = LIPOFILL_PLANS "/jaw_angle.json";

class FacesTest : public CliTest {
 protected:
  /// Carries the plan out into the folder "out" and returns its summary; null when that does not
  /// succeed.
  json run_jaw_angle(const std::string& options) const {
    const CommandResult result = run("lipofill run '" + std::string(kJawAngle) +
                                     "' --out out --spawn --discard --quiet --interval-ms 0 --json " + options);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output, nullptr, false);
  }

  void expect_files(const std::vector<std::string>& names) const {
    for (const std::string& name : names) EXPECT_TRUE(exists("out/" + name)) << name;
  }
};

std::string shared(const std::string& name) {
  return std::string(LIPOFILL_SHARED_DATA) + "/" + name;
}

bool have_shared_data() {
  return std::filesystem::exists(shared("lps_patient_before.obj")) && std::filesystem::exists(shared("james_face.obj"));
}

double number(const json& from, const char* name) {
  return from.at(name).get<double>();
}

/// What must hold on any face: the tissue comes to rest, no fat is lost, and the pockets hold the
/// fat the films say.
void expect_sound(const json& summary) {
  ASSERT_TRUE(summary.is_object());
  EXPECT_EQ(summary.at("state"), "SETTLED") << summary.at("reason");
  EXPECT_NEAR(number(summary, "injected_ml"), 4.5, 1e-9);
  EXPECT_LT(number(summary, "film_volume_relative_error"), 1e-10);
  EXPECT_LT(number(summary, "gap_volume_relative_error"), 1e-4);
  EXPECT_GT(number(summary, "min_scaled_jacobian"), 0.1);
  EXPECT_GT(number(summary, "min_pressure_pa"), -20e3);
  EXPECT_LT(number(summary, "max_pressure_pa"), 20e3);
  EXPECT_THAT(number(summary, "skin_max_displacement_mm"), AllOf(Gt(1.0), Lt(15.0)));
  // The base is bone, so the skin gives nearly all the room the fat takes.
  EXPECT_NEAR(number(summary, "skin_volume_change_ml"), number(summary, "injected_ml"), 0.5);
}

/// The two zones hold what was injected into each, and what wetted them.
void expect_fat_in_its_zones(const json& summary) {
  ASSERT_EQ(summary.at("zones").size(), 2u);
  const json& masseter = summary.at("zones")[0];
  const json& mandibular_angle = summary.at("zones")[1];
  EXPECT_EQ(masseter.at("name"), "masseter");
  EXPECT_EQ(mandibular_angle.at("name"), "mandibular_angle");
  EXPECT_THAT(number(masseter, "volume_ml"), AllOf(Gt(3.0), Lt(3.2)));
  EXPECT_THAT(number(mandibular_angle, "volume_ml"), AllOf(Gt(1.5), Lt(1.7)));
  EXPECT_NEAR(number(masseter, "volume_ml") + number(mandibular_angle, "volume_ml"), number(summary, "film_volume_ml"),
              1e-9);
}

TEST_F(FacesTest, ShippedFaceSettles) {
  const json summary = run_jaw_angle("");
  ASSERT_NO_FATAL_FAILURE(expect_sound(summary));
  expect_fat_in_its_zones(summary);
  EXPECT_EQ(summary, read_json("out/summary.json"));
  expect_files({"skin_0000.vtp", "skin_0001.vtp", "film_0001.vtp", "tissue_0001.vtu", "scan_0001.vtp", "skin.pvd",
                "film.pvd", "tissue.pvd", "scan.pvd", "series.csv", "run.json"});
  EXPECT_EQ(read("out/picture.png").substr(1, 3), "PNG");
  EXPECT_THAT(read("out/series.csv"), HasSubstr("probe_mandibular_angle_thickness_mm"));
}

TEST_F(FacesTest, PatientWithAtrophyComesNearerToTheGoal) {
  if (!have_shared_data()) GTEST_SKIP() << "no real scans in " << LIPOFILL_SHARED_DATA;
  const json summary = run_jaw_angle("--no-picture --scan '" + shared("lps_patient_before.obj") + "' --landmarks '" +
                                     shared("lps_patient.json#landmarks_before") + "' --evaluate '" +
                                     shared("lps_patient_target.obj") + "'");
  ASSERT_NO_FATAL_FAILURE(expect_sound(summary));
  expect_fat_in_its_zones(summary);
  expect_files({"evaluation.json", "distance.vtp"});

  const json evaluation = read_json("out/evaluation.json");
  const json& before = evaluation.at("before_to_target");
  const json& after = evaluation.at("simulated_to_target");
  for (const char* figure : {"mean_mm", "rms_mm", "p95_mm", "max_mm"}) {
    std::cout << figure << " to the goal: before " << before.at(figure) << ", after " << after.at(figure) << "\n";
    EXPECT_LT(number(after, figure), number(before, figure)) << figure;
  }
  const double missing = number(evaluation.at("volume_before"), "deficit_ml");
  const double left = number(evaluation.at("volume_simulated"), "deficit_ml");
  std::cout << "missing within the patch: before " << missing << " mL, after " << left << " mL\n";
  EXPECT_THAT(missing, AllOf(Gt(4.0), Lt(10.9))) << "10.817 mL are missing on the whole cheek";
  EXPECT_LT(left, missing);
  EXPECT_EQ(evaluation.at("mesh"), "scan");
  EXPECT_GT(evaluation.at("points"), 100);
  // The atrophy is 7.486 mm at its deepest vertex.
  EXPECT_THAT(number(before, "max_mm"), AllOf(Gt(7.0), Lt(7.5)));
  EXPECT_GE(number(evaluation, "hausdorff_mm"), number(after, "max_mm"));
  // The far side of the head is 130 mm away and not compared.
  EXPECT_LT(number(evaluation, "hausdorff_mm"), number(before, "max_mm"));
}

TEST_F(FacesTest, RawScanWithHolesAndSpecksSettles) {
  if (!have_shared_data()) GTEST_SKIP() << "no real scans in " << LIPOFILL_SHARED_DATA;
  const json summary = run_jaw_angle("--no-picture --scan '" + shared("james_face.obj") + "' --landmarks '" +
                                     shared("james_face.landmarks.json") + "'");
  ASSERT_NO_FATAL_FAILURE(expect_sound(summary));
  expect_fat_in_its_zones(summary);
  EXPECT_FALSE(exists("out/evaluation.json"));
}

}  // namespace
}  // namespace lipofill::testing
