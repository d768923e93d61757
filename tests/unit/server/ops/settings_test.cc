#include "server/ops/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "server/ops/listen_address.h"
#include "tests/unit/server/temporary_directory.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SettingsTest : public ::testing::Test {
 protected:
  ~SettingsTest() override {
    for (const Setting& setting : settings_) ::unsetenv(setting.environment_name().c_str());
  }

  /// The violation of the only setting that is given.
  std::string violation(const std::string& name, std::vector<std::string> texts) {
    FieldViolations violations;
    assign_settings(settings_, {{name, {std::move(texts), "here"}}}, violations);
    return violations.empty() ? "" : violations.all()[0].field + ": " + violations.all()[0].description;
  }
  absl::StatusOr<GivenValues> read_file(const std::string& text) {
    const std::string path = directory_.file("settings.toml");
    std::ofstream(path) << text;
    return read_settings_file(path, settings_);
  }

  lipofill::testing::TemporaryDirectory directory_;
  int count_ = 3;
  uint64_t space_mb_ = 8;
  double time_s_ = 1.5;
  bool quiet_ = false;
  std::string shape_ = "round";
  std::vector<std::string> places_ = {"here"};
  const std::vector<Setting> settings_ = {
      {"max-count", "N", "", &count_, 1, 9},
      {"time-s", "SECONDS", "", &time_s_, 0.5, 10},
      {"quiet", "", "", &quiet_},
      {.name = "shape", .value_name = "SHAPE", .help = "", .target = &shape_, .choices = {"round", "square"}},
      {"places", "PLACE", "", &places_},
      {"space-mb", "MB", "", &space_mb_, 1, 1e8},
  };
};

TEST_F(SettingsTest, TakeValuesOfTheirKind) {
  FieldViolations violations;
  assign_settings(settings_,
                  {{"max-count", {{"9"}, ""}},
                   {"time-s", {{"0.5"}, ""}},
                   {"quiet", {{"true"}, ""}},
                   {"shape", {{"square"}, ""}},
                   {"places", {{"a", "b"}, ""}},
                   {"space-mb", {{"100000000"}, ""}}},
                  violations);
  EXPECT_THAT(violations.all(), IsEmpty());
  EXPECT_EQ(count_, 9);
  EXPECT_EQ(time_s_, 0.5);
  EXPECT_EQ(space_mb_, 100'000'000u);
  EXPECT_TRUE(quiet_);
  EXPECT_EQ(shape_, "square");
  EXPECT_THAT(places_, ElementsAre("a", "b"));
}

TEST_F(SettingsTest, NameWhatIsWrongWithAValueAndKeepTheOldOne) {
  EXPECT_EQ(violation("max-count", {"10"}), "max-count: is \"10\" (from here), must be an integer in [1, 9]");
  EXPECT_EQ(violation("max-count", {"2.5"}), "max-count: is \"2.5\" (from here), must be an integer in [1, 9]");
  EXPECT_EQ(violation("max-count", {"1", "2"}), "max-count: is \"1, 2\" (from here), must be an integer in [1, 9]");
  EXPECT_EQ(violation("time-s", {"nan"}), "time-s: is \"nan\" (from here), must be a number in [0.5, 10]");
  EXPECT_EQ(violation("space-mb", {"-1"}), "space-mb: is \"-1\" (from here), must be an integer in [1, 1e+08]");
  EXPECT_EQ(violation("quiet", {"perhaps"}), "quiet: is \"perhaps\" (from here), must be true or false");
  EXPECT_EQ(violation("shape", {"flat"}), "shape: is \"flat\" (from here), must be one of round, square");
  EXPECT_EQ(violation("places", {"a", ""}), "places: is \"a, \" (from here), must be a list of texts");
  EXPECT_EQ(count_, 3);
  EXPECT_EQ(shape_, "round");
  EXPECT_THAT(places_, ElementsAre("here"));
}

TEST_F(SettingsTest, AreReadFromAFile) {
  const auto given = read_file(
      "# a comment\n"
      "max_count = 4  # either way to write it\n"
      "quiet = true\n"
      "shape = \"square\"\n"
      "places = [\"a b\", \"c\"]\n");
  ASSERT_TRUE(given.ok()) << given.status();
  EXPECT_THAT(given->at("max-count").texts, ElementsAre("4"));
  EXPECT_THAT(given->at("quiet").texts, ElementsAre("true"));
  EXPECT_THAT(given->at("shape").texts, ElementsAre("square"));
  EXPECT_THAT(given->at("places").texts, ElementsAre("a b", "c"));
  EXPECT_THAT(given->at("shape").source, HasSubstr("settings.toml"));
}

TEST_F(SettingsTest, RefuseFilesThatSayWhatNobodyReads) {
  EXPECT_THAT(read_file("max-cuont = 4\n").status().message(), HasSubstr("max-cuont: in "));
  EXPECT_THAT(read_file("max-count = 4\nquiet = true\nmax_count = 5\n").status().message(), HasSubstr("twice"));
  EXPECT_THAT(read_settings_file(directory_.file("none"), settings_).status().message(), HasSubstr("cannot be read"));
}

TEST_F(SettingsTest, AreReadFromTheEnvironment) {
  EXPECT_EQ(settings_[0].environment_name(), "LIPOFILLD_MAX_COUNT");
  ::setenv("LIPOFILLD_MAX_COUNT", "7", 1);
  ::setenv("LIPOFILLD_PLACES", "a,b", 1);
  const GivenValues given = read_settings_environment(settings_);
  ASSERT_EQ(given.size(), 2u);
  EXPECT_THAT(given.at("max-count").texts, ElementsAre("7"));
  EXPECT_EQ(given.at("max-count").source, "LIPOFILLD_MAX_COUNT");
  EXPECT_THAT(given.at("places").texts, ElementsAre("a", "b"));
}

TEST_F(SettingsTest, AreWrittenAsAFileHasThem) {
  EXPECT_EQ(settings_[0].text(), "3");
  EXPECT_EQ(settings_[1].text(), "1.5");
  EXPECT_EQ(settings_[2].text(), "false");
  EXPECT_EQ(settings_[3].text(), "\"round\"");
  EXPECT_EQ(settings_[4].text(), "[\"here\"]");
}

TEST(ListenAddress, IsLocalOnLoopbackAndOnUnixSockets) {
  for (const char* text : {"127.0.0.1:1", "127.9.9.9:0", "localhost:50061", "[::1]:50061", "unix:/run/a", "unix:a"}) {
    const auto address = parse_listen_address(text);
    ASSERT_TRUE(address.ok()) << text << ": " << address.status();
    EXPECT_TRUE(address->is_local()) << text;
  }
  for (const char* text : {"0.0.0.0:1", "[::]:1", "192.168.0.1:1", "lipofill.example:50061", "*:1", "1270.0.1:1"}) {
    const auto address = parse_listen_address(text);
    ASSERT_TRUE(address.ok()) << text << ": " << address.status();
    EXPECT_FALSE(address->is_local()) << text;
  }
}

TEST(ListenAddress, IsTakenApart) {
  EXPECT_EQ(parse_listen_address("10.0.0.1:8080")->host, "10.0.0.1");
  EXPECT_EQ(parse_listen_address("10.0.0.1:8080")->port, 8080);
  EXPECT_EQ(parse_listen_address("[::1]:8080")->host, "::1");
  EXPECT_EQ(parse_listen_address("unix:///run/lipofill/socket")->unix_path, "/run/lipofill/socket");
}

TEST(ListenAddress, SaysWhatIsWrongWithIt) {
  EXPECT_THAT(parse_listen_address("50061").status().message(), HasSubstr("must be HOST:PORT"));
  EXPECT_THAT(parse_listen_address(":50061").status().message(), HasSubstr("must be HOST:PORT"));
  EXPECT_THAT(parse_listen_address("a:65536").status().message(),
              HasSubstr("\"65536\", must be an integer in [0, 65535]"));
  EXPECT_THAT(parse_listen_address("a:http").status().message(), HasSubstr("\"http\""));
  EXPECT_THAT(parse_listen_address("::1:50061").status().message(), HasSubstr("brackets"));
  EXPECT_THAT(parse_listen_address("unix:").status().message(), HasSubstr("1 to 107 bytes"));
  EXPECT_THAT(parse_listen_address("unix:" + std::string(200, 'x')).status().message(), HasSubstr("has 200"));
}

}  // namespace
}  // namespace lipofill::server
