// lipofill target: files alone, and scans that a daemon keeps.

#include <fstream>
#include <memory>

#include "tests/integration/cli/cli_fixture.h"
#include "tests/integration/service/daemon_process.h"
#include "tests/unit/planning/test_heads.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

std::string to_obj(const geometry::SurfaceMesh& mesh) {
  std::ostringstream text;
  text.precision(10);
  for (int v = 0; v < mesh.n_vertices(); ++v) text << "v " << 1e3 * mesh.points.col(v).transpose() << "\n";
  for (const auto& t : mesh.triangles) text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  return text.str();
}

std::string to_landmarks_file(const geometry::Landmarks& landmarks) {
  nlohmann::json file;
  for (const auto& [name, p] : landmarks) file["landmarks"][name] = {1e3 * p[0], 1e3 * p[1], 1e3 * p[2]};
  return file.dump();
}

/// A head whose left cheek has sunk in by 5 mm, and the same head before, in another pose.
class TargetTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    std::vector<planning::Bump> bumps = planning::symmetric_bumps();
    const geometry::SurfaceMesh healthy = planning::make_head(bumps);
    bumps.push_back({{0.75, -0.35, 0.4}, 0.25, -0.005});
    write("face.obj", to_obj(planning::make_head(bumps)));
    write("before.obj", to_obj(planning::move_surface(healthy, planning::make_pose())));
    geometry::Landmarks landmarks = planning::make_landmarks(healthy);
    write("face.json", to_landmarks_file(landmarks));
    for (const char* name : {"exocanthion", "cheilion", "zygion", "gonion", "tragion"}) {
      std::swap(landmarks[std::string(name) + "_left"], landmarks[std::string(name) + "_right"]);
    }
    write("swapped.json", to_landmarks_file(landmarks));
  }
};

TEST_F(TargetTest, OfTheHealthySideAndOfAnEarlierScanAgree) {
  const auto mirrored = answer_of("lipofill target face.obj --landmarks face.json --healthy right --json");
  const auto earlier =
      answer_of("lipofill target face.obj --landmarks face.json --surface before.obj --out t.obj --json");
  EXPECT_EQ(earlier["target"]["report"]["registration"]["start"], "shape");
  EXPECT_GT(earlier["target"]["report"]["registration"]["confidence"].get<double>(), 0.1)
      << "a head that is nearly an ellipsoid has other places where much of it fits";
  const double by_mirror = mirrored["deficit"]["all"]["volume"]["deficit_ml"];
  const double by_scan = earlier["deficit"]["all"]["volume"]["deficit_ml"];
  EXPECT_GT(by_scan, 1.0);
  EXPECT_NEAR(by_mirror / by_scan, 1.0, 0.05);
  EXPECT_THAT(read("t.obj"), HasSubstr("\nf "));
  const CommandResult text = run("lipofill target face.obj --landmarks face.json --healthy right");
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_THAT(text.output, HasSubstr("masseter_left"));
  EXPECT_THAT(text.output, HasSubstr("symmetry index"));
}

TEST_F(TargetTest, DrawsWhatIsMissing) {
  const auto drawn = answer_of("lipofill target face.obj --landmarks face.json --healthy right --sheet missing.png");
  EXPECT_TRUE(drawn["deficit"]["distance_mm"].empty()) << "the map is in the picture";
  const std::string png = read("missing.png");
  ASSERT_GT(png.size(), 24u);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\x07\xd0\0\0\x03\x84", 8)) << "2000 x 900 pixels";
  const CommandResult refused = run("lipofill target face.obj --landmarks face.json --healthy right --sheet no/m.png");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("no/m.png"));
}

TEST_F(TargetTest, IsKeptOnADaemonForEvaluations) {
  const DaemonProcess daemon((folder_ / "data").string());
  const std::string lipofill = "env LIPOFILL_SERVER=" + daemon.address() + " lipofill ";
  answer_of(lipofill + "patient create --id p --json");
  const auto made = answer_of(lipofill + "target face.obj --landmarks face.json --healthy right --patient p --json");
  const std::string scan = made["target"]["scan"];
  EXPECT_THAT(scan, HasSubstr("patients/p/scans/"));
  const auto kept = answer_of(lipofill + "scan get " + scan + " --json");
  EXPECT_EQ(kept["complete"], true);
  EXPECT_EQ(kept["report"]["target"]["mirrored_side"], "right");
}

TEST_F(TargetTest, SaysWhatIsWrong) {
  const auto refusal_of = [&](const std::string& options) {
    const CommandResult result = run("lipofill target face.obj " + options);
    EXPECT_NE(result.exit_code, 0) << options;
    return result.errors;
  };
  EXPECT_THAT(refusal_of("--healthy right"), HasSubstr("--landmarks"));
  EXPECT_THAT(refusal_of("--landmarks face.json"), HasSubstr("--surface"));
  EXPECT_THAT(refusal_of("--landmarks swapped.json --healthy right"), HasSubstr("spec.landmarks_mm"));
  EXPECT_THAT(refusal_of("--surface before.obj --in-place"), HasSubstr("cannot be placed on the face"));
  EXPECT_THAT(refusal_of("--landmarks face.json --surface face.obj --surface-landmarks swapped.json"),
              HasSubstr("left and right are swapped"));
}

}  // namespace
}  // namespace lipofill::testing
