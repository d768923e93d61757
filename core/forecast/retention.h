#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/forecast/distribution.h"

namespace lipofill::forecast {

enum class RetentionPreset { kPooled, kAcquiredAtrophy, kMixedIndications, kCottonPad, kCentrifuge };

/// A point of a curve: the share of the fat that is left after some months.
struct RetentionPoint {
  double month = 0.0;
  double share = 0.0;
};

/// The specification says what is asked for; lipofill.v1.Retention.
struct RetentionSpec {
  RetentionPreset preset = RetentionPreset::kPooled;
  std::vector<RetentionPoint> points;  ///< a curve of one's own in place of the preset; may be empty
  std::optional<double> spread;        ///< standard deviation of the share after 12 months
};

/// Fat that was found left: a share of what was injected.
struct KeptShare {
  double month = 0.0;
  double share = 0.0;
  double standard_error = 0.0;
};

/// Retention tells how much of injected fat is left after t months, as far as it is known. Patients
/// differ in one number, the share a that is left after 12 months:
///
///     R(t) = 1 - (1 - a) L(t),   L(t) = (1 - C(t)) / (1 - C(12)),   a normal(m, s), cut off to [0.03, 1]
///
/// with C the mean curve: of a preset that of the cotton pad trial (Wu 2018),
///
///     C = (0.398 + 0.085 exp(-t / 6.25) + 0.518 exp(-t / 0.309)) / 1.001
///
/// which with a = 0.34 tells the trial's centrifuge arm to 0.02. Published intervals are those of
/// means. From patient to patient the share differs by 0.16 (assumed), the standard deviation from
/// study to study behind the pooled interval: 0.03 sqrt(27).
///
///     | preset             | m    | standard error of m | source                  |
///     | kPooled            | 0.47 | 0.031               | Lv 2021, 27 studies     |
///     | kAcquiredAtrophy   | 0.43 | 0.077               | JPRAS 2023              |
///     | kMixedIndications  | 0.64 | 0.036               | JPRAS 2023              |
///     | kCottonPad         | 0.41 | not told            | Wu 2018                 |
///     | kCentrifuge        | 0.34 | not told            | Wu 2018                 |
///
/// Checked by tests/unit/forecast/retention_test.cc.
class Retention {
 public:
  /// Field violations named as in lipofill.v1.Retention: a curve above 1, one that rises, months
  /// that do not ascend or end before the third.
  static absl::StatusOr<Retention> create(const RetentionSpec& spec);

  /// L(t): the fat that is lost until then, over what is lost until month 12.
  double lost(double month) const;
  /// R(t) of a patient with `at_12_months` left then.
  double share(double month, double at_12_months) const {
    return std::clamp(1.0 - (1.0 - at_12_months) * lost(month), 0.0, 1.0);
  }
  /// Tells how the share after 12 months is distributed.
  const Distribution& at_12_months() const { return at_12_months_; }
  /// The share that a part of all patients have less of.
  double quantile(double month, double part) const { return share(month, at_12_months_.quantile(part)); }
  double mean(double month) const;
  const std::string& source() const { return source_; }
  bool is_updated() const { return is_updated_; }

  /// The retention of a patient in whom so much was found (Bayes): y = R(t) + e is linear in a, so
  /// that the normal prior has a normal posterior, cut off like the prior. e holds the error of the
  /// measurement, and 0.03 by which a patient is off the curve (assumed).
  Retention updated_by(const KeptShare& found) const;

 private:
  Distribution at_12_months_;
  std::vector<RetentionPoint> points_;  ///< empty: the curve of the presets
  std::string source_;
  bool is_updated_ = false;
};

/// Adds what is wrong with a follow-up of so much injected fat [m3].
/// @param kept  found left, with its standard error [m3]
void check_follow_up(std::string_view field, double month, double kept, double standard_error, double injected,
                     FieldViolations& violations);

}  // namespace lipofill::forecast
