// lipofill scan check and scan landmarks: what they say of files as programs in the wild write
// them.

#include <filesystem>
#include <sstream>

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using ::testing::HasSubstr;

/// A dome of 25 x 25 vertices over 120 mm, moved.
std::string dome_obj(double east_mm) {
  constexpr int kSteps = 24;
  std::ostringstream text;
  text.precision(14);
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const double x = 120.0 * i / kSteps - 60.0;
      const double y = 120.0 * j / kSteps - 60.0;
      text << "v " << x + east_mm << " " << y << " " << 30.0 - (x * x + y * y) / 240.0 << "\n";
    }
  }
  const auto at = [](int i, int j) { return j * (kSteps + 1) + i + 1; };
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i)
      text << "f " << at(i, j) << " " << at(i + 1, j) << " " << at(i + 1, j + 1) << " " << at(i, j + 1) << "\n";
  }
  return text.str();
}

class ScanCheckTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    write("dome.obj", dome_obj(0.0) + "f 1 2\nv 900 0 nan\nvc 1 2 3\nf 1 2 27\n");
  }
};

TEST_F(ScanCheckTest, SaysWhatWasFoundPassedOverAndMended) {
  const CommandResult text = run("lipofill scan check dome.obj");
  ASSERT_EQ(text.exit_code, 0) << text.output;
  for (const char* said : {"625 vertices, 1153 triangles, 120 x 120 x 30 mm", "2 non-manifold edges",
                           "1 face of fewer than three corners left out", "1 vertex of no face left out",
                           "1 statement that shapes no polygon passed over: 'vc'", "triangle given more than once"}) {
    EXPECT_THAT(text.output, HasSubstr(said));
  }
  const auto answer = answer_of("lipofill scan check dome.obj --json");
  EXPECT_EQ(answer["file"], "dome.obj");
  EXPECT_EQ(answer["report"]["vertices"], 625);
  EXPECT_EQ(answer["report"]["read_remarks"].size(), 3u);
  EXPECT_EQ(answer["report"]["mending_remarks"].size(), 1u);
}

TEST_F(ScanCheckTest, DrawsThePicture) {
  const auto answer = answer_of("lipofill scan check dome.obj --picture dome.png --json");
  EXPECT_EQ(answer["picture"], "dome.png");
  EXPECT_THAT(read("dome.png").substr(0, 8), HasSubstr("PNG"));
  EXPECT_GT(read("dome.png").size(), 20'000u);
}

TEST_F(ScanCheckTest, RefusesWhatCannotBeRead) {
  write("bad.obj", "v 0 0 0\nv 1 0 zero\n");
  const CommandResult bad = run("lipofill scan check bad.obj");
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.errors, HasSubstr("line 2: vertex coordinate 'zero' is not a number"));
  EXPECT_EQ(run("lipofill scan check none.obj").exit_code, 2);
}

TEST_F(ScanCheckTest, FarFromTheOriginAScanIsTheSame) {
  write("far.obj", dome_obj(5e8));
  const auto far = answer_of("lipofill scan check far.obj --picture far.png --json");
  EXPECT_NEAR(far["report"]["size_x_mm"].get<double>(), 120.0, 1e-6);
  write("near.obj", dome_obj(0.0));
  answer_of("lipofill scan check near.obj --picture near.png --json");
  // The picture of the near one is drawn from single precision: the two differ by grey levels
  // alone.
  EXPECT_NEAR(static_cast<double>(read("far.png").size()), static_cast<double>(read("near.png").size()), 2000.0);
}

TEST_F(ScanCheckTest, LandmarksGoFromOneProgramToAnother) {
  write("a.fcsv", "1,-1,-2,3,0,0,0,1,1,1,0,go_l,,\n2,0,85.5,111,0,0,0,1,1,1,0,n,,\n");
  for (const char* name : {"b.mrk.json", "b.csv", "b.pp", "b.json", "b.fcsv"}) {
    ASSERT_EQ(run(std::string("lipofill scan landmarks a.fcsv --out ") + name).exit_code, 0);
    const auto back = answer_of(std::string("lipofill scan landmarks ") + name + " --json");
    EXPECT_EQ(back["landmarks_mm"]["gonion_left"], nlohmann::json({1.0, 2.0, 3.0})) << name;
    EXPECT_EQ(back["landmarks_mm"]["nasion"][1], -85.5) << name;
  }
  EXPECT_THAT(answer_of("lipofill scan landmarks a.fcsv --json")["remarks"].dump(), HasSubstr("turned to LPS"));
  const CommandResult bad = run("lipofill scan landmarks a.fcsv --out a.doc");
  EXPECT_EQ(bad.exit_code, 2);
}

}  // namespace
}  // namespace lipofill::testing
