#include "core/forecast/retention.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/units.h"

namespace lipofill::forecast {
namespace {

constexpr double kYear = 12.0;
constexpr double kMostMonths = 60.0;
/// Less is left of no graft that was measured; the curve of the presets stays above 0 from there.
constexpr double kLeastShare = 0.03;
/// The share differs by so much from patient to patient.
constexpr double kPatientSpread = 0.16;
/// A patient is off the curve by so much at a follow-up.
constexpr double kOffCurve = 0.03;
/// Shares of a mean are summed over so many equal parts of the patients.
constexpr int kParts = 2000;

struct PresetRow {
  RetentionPreset preset;
  double mean;
  double standard_error;  ///< 0: not told
  const char* source;
};

constexpr std::array<PresetRow, 5> kRows = {{
    {RetentionPreset::kPooled, 0.47, 0.12 / (2 * 1.96), "pooled, 47 % (95 % CI 41-53, 27 studies; Lv 2021)"},
    {RetentionPreset::kAcquiredAtrophy, 0.43, 0.30 / (2 * 1.96), "acquired atrophy, 43 % (28-58; JPRAS 2023)"},
    {RetentionPreset::kMixedIndications, 0.64, 0.14 / (2 * 1.96), "mixed indications, 64 % (57-71; JPRAS 2023)"},
    {RetentionPreset::kCottonPad, 0.41, 0.0, "prepared on a cotton pad, 41 % (Wu 2018)"},
    {RetentionPreset::kCentrifuge, 0.34, 0.0, "prepared in a centrifuge, 34 % (Wu 2018)"},
}};

/// The fit to the cotton pad arm, which begins at 1.
double trial_curve(double month) {
  return (0.398 + 0.085 * std::exp(-month / 6.25) + 0.518 * std::exp(-month / 0.309)) / 1.001;
}

double curve_through(const std::vector<RetentionPoint>& points, double month) {
  RetentionPoint before{0.0, 1.0};
  for (const RetentionPoint& point : points) {
    if (month <= point.month) {
      return before.share + (point.share - before.share) * (month - before.month) / (point.month - before.month);
    }
    before = point;
  }
  return before.share;
}

void check_points(const std::vector<RetentionPoint>& points, FieldViolations& violations) {
  RetentionPoint before{0.0, 1.0};
  for (size_t k = 0; k < points.size(); ++k) {
    const std::string field = absl::StrCat("points[", k, "]");
    const RetentionPoint& point = points[k];
    violations.check_range(field + ".month", point.month, 0.0, kMostMonths, "months");
    if (!(point.month > before.month)) {
      violations.add(field + ".month", absl::StrCat("is ", point.month, ", must be later than ", before.month));
    }
    if (!(point.share >= kLeastShare && point.share <= 1.0)) {
      violations.add(field + ".share", absl::StrCat("is ", point.share, ", must be in [", kLeastShare,
                                                    ", 1]: no more is left than was injected"));
    } else if (point.share > before.share) {
      violations.add(field + ".share", absl::StrCat("is ", point.share, ", more than ", before.share,
                                                    " before: fat that is lost does not come back"));
    }
    before = point;
  }
  if (before.month < 3.0) {
    violations.add("points", absl::StrCat("end after ", before.month, " months, must reach month 3"));
  } else if (before.share >= 1.0) {
    violations.add("points", "lose nothing: without a loss there is no curve");
  }
}

std::string with_spread(const std::string& source, double spread, bool is_given) {
  return absl::StrFormat("%s; from patient to patient +- %.2f (%s)", source, spread,
                         is_given ? "as given" : "standard deviation, partly assumed");
}

}  // namespace

absl::StatusOr<Retention> Retention::create(const RetentionSpec& spec) {
  FieldViolations violations;
  if (!spec.points.empty()) check_points(spec.points, violations);
  if (spec.spread) violations.check_range("standard_deviation", *spec.spread, 0.01, 0.4, "");
  if (!violations.empty()) return violations.to_status();
  Retention retention;
  const PresetRow& row =
      *std::find_if(kRows.begin(), kRows.end(), [&](const PresetRow& r) { return r.preset == spec.preset; });
  const bool is_own = !spec.points.empty();
  const double mean = is_own ? curve_through(spec.points, kYear) : row.mean;
  const double spread = spec.spread.value_or(is_own ? kPatientSpread : std::hypot(kPatientSpread, row.standard_error));
  retention.points_ = spec.points;
  retention.at_12_months_ = {Law::kNormal, mean, spread, kLeastShare, 1.0};
  retention.source_ = with_spread(is_own ? "a curve of one's own" : row.source, spread, spec.spread.has_value());
  return retention;
}

double Retention::lost(double month) const {
  const auto curve = [this](double t) { return points_.empty() ? trial_curve(t) : curve_through(points_, t); };
  return (1.0 - curve(month)) / (1.0 - curve(kYear));
}

double Retention::mean(double month) const {
  double sum = 0.0;
  for (int k = 0; k < kParts; ++k) sum += at_12_months_.quantile((k + 0.5) / kParts);
  return share(month, sum / kParts);
}

Retention Retention::updated_by(const KeptShare& found) const {
  const double slope = lost(found.month);
  const double error = std::hypot(found.standard_error, kOffCurve) / slope;
  const double measured = 1.0 - (1.0 - found.share) / slope;  // the a of a patient with that share
  const double prior = 1.0 / (at_12_months_.spread * at_12_months_.spread), likelihood = 1.0 / (error * error);
  Retention next = *this;
  next.at_12_months_.centre = (prior * at_12_months_.centre + likelihood * measured) / (prior + likelihood);
  next.at_12_months_.spread = 1.0 / std::sqrt(prior + likelihood);
  next.source_ += absl::StrFormat("; with %.0f %% found left after %.3g months", 100.0 * found.share, found.month);
  next.is_updated_ = true;
  return next;
}

void check_follow_up(std::string_view field, double month, double kept, double standard_error, double injected,
                     FieldViolations& violations) {
  const std::string prefix(field);
  if (!(month > 0.0 && month <= kMostMonths)) {
    violations.add(prefix + ".month", absl::StrCat("is ", month, ", must be in (0, ", kMostMonths, "]"));
  }
  const double unit = kCubicMetresPerMillilitre;
  if (!(standard_error > 0.0) || !std::isfinite(standard_error)) {
    violations.add(prefix + ".standard_error_ml",
                   absl::StrCat("is ", standard_error / unit, " mL, must be greater than 0: no scan is exact"));
    return;
  }
  // Noise may take a measurement a little beyond what is possible.
  if (!std::isfinite(kept) || kept < -3.0 * standard_error || kept > injected + 3.0 * standard_error) {
    violations.add(prefix, absl::StrFormat("finds %.3g mL left of %.3g mL, which is more than three standard errors "
                                           "beyond what is possible",
                                           kept / unit, injected / unit));
  }
}

}  // namespace lipofill::forecast
