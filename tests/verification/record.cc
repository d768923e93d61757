#include "tests/verification/record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace lipofill::verification {
namespace {

using nlohmann::json;

const char* name_of(Bound bound) {
  switch (bound) {
    case Bound::kRelative:
      return "relative";
    case Bound::kAbsolute:
      return "absolute";
    case Bound::kAtMost:
      return "at_most";
    case Bound::kAtLeast:
      return "at_least";
    case Bound::kReported:
      return "reported";
  }
  return "";
}

bool holds(const Figure& figure) {
  const double difference = std::abs(figure.measured - figure.expected);
  switch (figure.bound) {
    case Bound::kRelative:
      return difference <= figure.tolerance * std::abs(figure.expected);
    case Bound::kAbsolute:
      return difference <= figure.tolerance;
    case Bound::kAtMost:
      return std::abs(figure.measured) <= figure.expected;
    case Bound::kAtLeast:
      return figure.measured >= figure.expected;
    case Bound::kReported:
      return std::isfinite(figure.measured);
  }
  return false;
}

std::string describe(const Figure& f) {
  const std::string unit = f.unit == "1" ? "" : " " + f.unit;
  const std::string measured = f.quantity + ": measured " + with_number("%.6g", f.measured) + unit;
  if (f.bound == Bound::kAtMost) return measured + ", at most " + with_number("%.4g", f.expected) + unit;
  if (f.bound == Bound::kAtLeast) return measured + ", at least " + with_number("%.4g", f.expected) + unit;
  std::string text = measured + ", expected " + with_number("%.6g", f.expected) + unit;
  if (f.expected != 0.0) text += with_number(" (%+.3g %%)", 100.0 * (f.measured / f.expected - 1.0));
  if (f.bound == Bound::kReported) return text;
  return text + ", tolerance " +
         (f.bound == Bound::kAbsolute ? with_number("%.3g", f.tolerance) + unit
                                      : with_number("%.3g %%", 100.0 * f.tolerance));
}

json to_json(const Figure& f) {
  return {{"quantity", f.quantity}, {"unit", f.unit},           {"expected", f.expected},
          {"measured", f.measured}, {"tolerance", f.tolerance}, {"bound", name_of(f.bound)}};
}

double observed_order_of(const Series& s) {
  const size_t n = s.errors.size();
  return std::log(std::abs(s.errors[n - 2] / s.errors[n - 1])) /
         std::abs(std::log(s.resolutions[n - 2] / s.resolutions[n - 1]));
}

json to_json(const Series& s) {
  return {{"quantity", s.quantity},
          {"resolution_name", s.resolution_name},
          {"resolutions", s.resolutions},
          {"errors", s.errors},
          {"expected_order", s.expected_order},
          {"least_order", s.least_order},
          {"observed_order", observed_order_of(s)}};
}

json to_json(const Curve& c) {
  return {{"name", c.name},
          {"x_label", c.x_label},
          {"y_label", c.y_label},
          {"x", c.x},
          {"measured", c.measured},
          {"expected", c.expected},
          {"logarithmic", c.logarithmic},
          {"measured_label", c.measured_label},
          {"expected_label", c.expected_label}};
}

template <typename T>
json to_json(const std::vector<T>& items) {
  json array = json::array();
  for (const T& item : items) array.push_back(to_json(item));
  return array;
}

/// "Suite.Name" of the running test.
std::string test_name() {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  return test ? std::string(test->test_suite_name()) + "." + test->name() : "none";
}

std::string without_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

}  // namespace

std::string with_number(const char* pattern, double value) {
  char text[200] = "";
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

Case::Case(CaseInfo info) : info_(std::move(info)) {
  const size_t slash = info_.id.find('/');
  EXPECT_TRUE(slash != std::string::npos && slash + 1 < info_.id.size() && std::isdigit(info_.id[slash + 1]))
      << "the id of a case is section/number-name, not " << info_.id;
}

void Case::record(const Figure& figure) {
  const std::string text = describe(figure);
  std::printf("%s: %s\n", info_.id.c_str(), text.c_str());
  EXPECT_TRUE(holds(figure)) << info_.id << ": " << text;
  figures_.push_back(figure);
  write();
}

double Case::record_series(const Series& series) {
  if (series.errors.size() < 2 || series.errors.size() != series.resolutions.size()) {
    ADD_FAILURE() << info_.id << ": a series has an error for each of two resolutions or more";
    return 0.0;
  }
  std::printf("%s: error of %s against %s:", info_.id.c_str(), series.quantity.c_str(), series.resolution_name.c_str());
  for (size_t i = 0; i < series.errors.size(); ++i) std::printf(" %.3e (%g)", series.errors[i], series.resolutions[i]);
  const double order = observed_order_of(series);
  std::printf("; order %.2f, expected %g, at least %g\n", order, series.expected_order, series.least_order);
  EXPECT_GE(order, series.least_order) << info_.id << ": " << series.quantity;
  series_.push_back(series);
  write();
  return order;
}

void Case::record_curve(const Curve& curve) {
  EXPECT_TRUE(curve.x.size() == curve.measured.size() && curve.x.size() == curve.expected.size())
      << info_.id << ": " << curve.name;
  curves_.push_back(curve);
  write();
}

void Case::write() const {
  const char* folder = std::getenv("LIPOFILL_VERIFICATION_DIR");
  if (!folder || !*folder) return;
  const json content = {{"id", info_.id},
                        {"title", info_.title},
                        {"reference", info_.reference},
                        {"test", test_name()},
                        {"figures", to_json(figures_)},
                        {"series", to_json(series_)},
                        {"curves", to_json(curves_)}};
  const std::filesystem::path path =
      std::filesystem::path(folder) / (without_slashes(info_.id + "." + test_name()) + ".json");
  const std::filesystem::path part = path.string() + ".part";
  std::ofstream file(part);
  file << content.dump(1) << "\n";
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(part, path, error);
  EXPECT_TRUE(file && !error) << "cannot write " << path << " " << error.message();
}

}  // namespace lipofill::verification
