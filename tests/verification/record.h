#pragma once

#include <string>
#include <vector>

namespace lipofill::verification {

/// How a measured figure is held against the expected one.
enum class Bound {
  kRelative,  ///< |measured - expected| <= tolerance |expected|
  kAbsolute,  ///< |measured - expected| <= tolerance
  kAtMost,    ///< |measured| <= expected, which is a bound; no tolerance
  kAtLeast,   ///< measured >= expected, which is a bound; no tolerance
  kReported,  ///< shown on the page, asserted nowhere: a known limit of the model beside its figure
};

struct Figure {
  std::string quantity;  ///< for example "front after 10 s"
  std::string unit;      ///< both values have it; "1" for ratios
  double expected = 0.0;
  double measured = 0.0;
  double tolerance = 0.0;
  Bound bound = Bound::kRelative;
};

/// Errors under refinement, coarse to fine. The order is observed between the last two.
struct Series {
  std::string quantity;             ///< whose error
  std::string resolution_name;      ///< for example "cells along the strip" or "t/b": the plot's axis
  std::vector<double> resolutions;  ///< growing (a number of cells) or shrinking (a size), monotone
  std::vector<double> errors;       ///< relative, signed or not
  double expected_order = 2.0;
  double least_order = 1.8;  ///< asserted
};

/// Points measured beside a reference, for a plot on the page.
struct Curve {
  std::string name;
  std::string x_label;  ///< names the axis and its unit
  std::string y_label;
  std::vector<double> x;
  std::vector<double> measured;
  std::vector<double> expected;
  bool logarithmic = false;  ///< both axes
  std::string measured_label = "measured";
  std::string expected_label = "expected";
};

/// One case of the verification suite: a problem whose answer is known without the solver.
struct CaseInfo {
  /// "section/number-name" in lower case: film/3-barenblatt. The section and the number place it on
  /// the page; sections are film, coupled, solid, fat, anatomy, conservation. Tests may share a
  /// case.
  std::string id;
  std::string title;
  std::string reference;  ///< where the expected values come from, in a sentence
};

/// A number in a name: with_number("front after %g s", 10.0). `pattern` is of printf, for one
/// double.
std::string with_number(const char* pattern, double value);

/// Collects what a test measures. Every call prints measured against expected, asserts what its
/// bound says (as EXPECT_ does: the test goes on and fails) and, where the environment names a
/// folder in LIPOFILL_VERIFICATION_DIR, rewrites the test's file of that case there, atomically:
/// tests may run in parallel. `deploy/verify` makes core/doc/verification.md from these files.
/// Checked by tests/verification/record_test.cc.
class Case {
 public:
  explicit Case(CaseInfo info);

  /// Asserts a figure.
  void record(const Figure& figure);

  /// Asserts that the observed order is at least series.least_order, and returns it:
  /// log(e1/e2) / |log(n1/n2)| of the last two.
  double record_series(const Series& series);

  /// Asserts nothing.
  void record_curve(const Curve& curve);

 private:
  void write() const;

  CaseInfo info_;
  std::vector<Figure> figures_;
  std::vector<Series> series_;
  std::vector<Curve> curves_;
};

}  // namespace lipofill::verification
