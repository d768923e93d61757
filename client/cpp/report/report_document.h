#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "client/cpp/report/document.h"
#include "client/cpp/report/reader.h"

namespace lipofill::client {

/// The pictures of a report by name, and the colours that they are in.
struct ReportPictures {
  std::string problem;  ///< why there are none; empty where there are
  std::map<std::string, std::string> png;
  double largest_displacement_mm = 0.0;
  double largest_distance_mm = 0.0;
  double distance_line_mm = 1.0;
  std::vector<std::string> displacement_colours;
  std::vector<std::string> distance_colours;
  std::array<std::string, 4> band_colours;  ///< of settled pressure, from low to high
};

/// Names of the pictures of a view: "before-front", "planned-front", "remaining-front",
/// "target-front".
inline constexpr std::array<const char*, 5> kViewNames = {"right_profile", "right_oblique", "front", "left_oblique",
                                                          "left_profile"};

/// A report of a record: every figure of it is a field of the record. What was not asked for is
/// said in a sentence. Checked by tests/integration/cli/report_test.cc.
ReportDocument make_report_document(const RecordReader& reader, const ReportPictures& pictures, Paper paper);

}  // namespace lipofill::client
