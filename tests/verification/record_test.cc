#include "tests/verification/record.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace lipofill::verification {
namespace {

const CaseInfo kInfo{"film/9-example", "An example", "none"};

/// Names a folder for the files of cases while it lives.
struct RecordFolder {
  std::filesystem::path path;
  RecordFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "lipofill-record-XXXXXX").string();
    path = mkdtemp(name.data());
    setenv("LIPOFILL_VERIFICATION_DIR", path.c_str(), 1);
  }
  ~RecordFolder() {
    unsetenv("LIPOFILL_VERIFICATION_DIR");
    std::filesystem::remove_all(path);
  }
};

TEST(Record, WritesAFileATestAndACase) {
  const RecordFolder folder;
  Case example(kInfo);
  example.record({"height", "mm", 2.0, 2.01, 0.01});
  example.record_series({"height", "cells", {10, 20}, {4e-2, 1e-2}, 2.0, 1.9});
  example.record_curve({"profile", "x [mm]", "h [mm]", {0, 1}, {1, 2}, {1, 2.1}});
  const auto path = folder.path / "film_9-example.Record.WritesAFileATestAndACase.json";
  std::ifstream file(path);
  const auto content = nlohmann::json::parse(file);
  EXPECT_EQ(content["id"], "film/9-example");
  EXPECT_EQ(content["test"], "Record.WritesAFileATestAndACase");
  EXPECT_EQ(content["figures"][0]["measured"], 2.01);
  EXPECT_EQ(content["figures"][0]["bound"], "relative");
  EXPECT_NEAR(content["series"][0]["observed_order"].get<double>(), 2.0, 1e-12);
  EXPECT_EQ(content["curves"][0]["y_label"], "h [mm]");
  const auto files = std::filesystem::directory_iterator(folder.path);
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

void record_out_of(Bound bound) {
  Case(kInfo).record({"height", "mm", 2.0, bound == Bound::kAtLeast ? 1.9 : 2.1, 0.04, bound});
}

TEST(Record, FailsTheTestWhereAFigureIsOutOfItsBound) {
  EXPECT_NONFATAL_FAILURE(record_out_of(Bound::kRelative), "measured 2.1 mm, expected 2 mm (+5 %), tolerance 4 %");
  EXPECT_NONFATAL_FAILURE(record_out_of(Bound::kAbsolute), "tolerance 0.04 mm");
  EXPECT_NONFATAL_FAILURE(record_out_of(Bound::kAtMost), "at most 2 mm");
  EXPECT_NONFATAL_FAILURE(record_out_of(Bound::kAtLeast), "at least 2 mm");
  EXPECT_NONFATAL_FAILURE(Case(kInfo).record({"height", "mm", 2.0, std::nan(""), 0.04}), "measured nan");
}

TEST(Record, FailsTheTestWhereTheOrderIsTooLow) {
  const Series series{"height", "t/b", {0.1, 0.05}, {-2e-2, -1e-2}, 2.0, 1.8};
  EXPECT_NONFATAL_FAILURE(Case(kInfo).record_series(series), "height");
}

TEST(Record, RefusesAnIdWithoutAPlaceOnThePage) {
  EXPECT_NONFATAL_FAILURE(Case({"barenblatt", "", ""}), "section/number-name");
}

}  // namespace
}  // namespace lipofill::verification
