// lipofill scan series and scan extract on DICOM, as a clinic hands it over.

#include "tests/unit/client/test_dicom.h"

#include "tests/integration/cli/cli_fixture.h"

namespace lipofill::testing {
namespace {

using client::TestSeries;
using ::testing::HasSubstr;
using ::testing::Not;

class CliDicomTest : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    series_.write(folder_ / "ct");
  }
  /// Runs a command that must fail with the exit code of bad input, and gives what it says.
  std::string failure_of(const std::string& line) const {
    const CommandResult result = run(line);
    EXPECT_EQ(result.exit_code, 2) << result.errors;
    EXPECT_THAT(result.output + result.errors, Not(HasSubstr("SECRET")));
    EXPECT_FALSE(exists("bad.ply"));
    return result.errors;
  }
  TestSeries series_;
};

TEST_F(CliDicomTest, SeriesAreListed) {
  const auto listing = answer_of("lipofill scan series ct --json");
  ASSERT_EQ(listing["series"].size(), 1U);
  EXPECT_EQ(listing["series"][0]["number"], 2);
  EXPECT_EQ(listing["series"][0]["description"], "Head 1.5 mm");
  EXPECT_EQ(listing["series"][0]["size"], nlohmann::json({40, 36, 32}));
  EXPECT_EQ(listing["series"][0]["spacing_mm"], nlohmann::json({1.0, 1.25, 1.5}));
  EXPECT_EQ(listing["patients"], 1);
  const CommandResult text = run("lipofill scan series ct");
  EXPECT_THAT(text.output, HasSubstr("2 (CT, 40 x 36 x 32)  Head 1.5 mm"));
  EXPECT_THAT(text.output, Not(HasSubstr("SECRET")));
}

TEST_F(CliDicomTest, TheSkinOfASeriesHasNothingOfThePatient) {
  const auto skin = answer_of("lipofill scan extract ct --isovalue -500 --out skin.ply --json");
  EXPECT_NEAR(skin["bounds_mm"][0].get<double>(), 25 - 14, 0.05);
  EXPECT_NEAR(skin["bounds_mm"][5].get<double>(), 31 + 14, 0.05);
  EXPECT_EQ(skin["frame"], "LPS");
  EXPECT_THAT(skin["remarks"][0].get<std::string>(),
              HasSubstr("series 2 (CT, 40 x 36 x 32 voxels of 1 x 1.25 x 1.5 mm)"));
  for (const std::string& text : {skin.dump(), read("skin.ply")}) {
    EXPECT_THAT(text, Not(HasSubstr("SECRET")));
    EXPECT_THAT(text, Not(HasSubstr("4711")));
  }
  series_.write_frames(folder_ / "head.dcm");
  EXPECT_EQ(answer_of("lipofill scan extract head.dcm --isovalue -500 --out b.ply --json")["bounds_mm"],
            skin["bounds_mm"]);
}

TEST_F(CliDicomTest, BadInputSaysWhatToDo) {
  EXPECT_THAT(failure_of("lipofill scan extract ct --series 7 --out bad.ply"), HasSubstr("there are 2 (CT"));
  EXPECT_THAT(failure_of("lipofill scan extract ct --isovalue 3000 --out bad.ply"),
              HasSubstr("its values go from -1000 to 0; try --isovalue"));
  for (const int k : {15, 16}) std::filesystem::remove(folder_ / "ct" / absl::StrFormat("IM%04d", (k * 7) % 32));
  EXPECT_THAT(failure_of("lipofill scan extract ct --out bad.ply"), HasSubstr("--bridge-gaps"));
  answer_of("lipofill scan extract ct --bridge-gaps --isovalue -500 --out skin.ply --json");
  std::filesystem::create_directories(folder_ / "plain");
  write("plain/notes.txt", "no DICOM");
  EXPECT_THAT(failure_of("lipofill scan series plain"), HasSubstr("holds no DICOM image: 1 files are no DICOM"));
  EXPECT_THAT(failure_of("lipofill scan series plain --json"), HasSubstr("INVALID_ARGUMENT"));
  write("bad.zip", "PK\x03\x04 and no more");
  EXPECT_THAT(failure_of("lipofill scan extract bad.zip --out bad.ply"), HasSubstr("bad.zip"));
}

}  // namespace
}  // namespace lipofill::testing
