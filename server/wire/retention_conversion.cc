#include "server/wire/retention_conversion.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
#include "core/forecast/sessions.h"
#include "server/wire/forecast_conversion.h"

namespace lipofill::server {
namespace {

using forecast::RetentionPreset;

constexpr double kMl = kCubicMetresPerMillilitre;
constexpr double kMostMonths = 60.0;
constexpr double kMostMl = 1000.0;
constexpr size_t kMostPoints = 120;

RetentionPreset to_preset(v1::Retention::Preset preset) {
  switch (preset) {
    case v1::Retention::ACQUIRED_ATROPHY:
      return RetentionPreset::kAcquiredAtrophy;
    case v1::Retention::MIXED_INDICATIONS:
      return RetentionPreset::kMixedIndications;
    case v1::Retention::COTTON_PAD:
      return RetentionPreset::kCottonPad;
    case v1::Retention::CENTRIFUGE:
      return RetentionPreset::kCentrifuge;
    default:
      return RetentionPreset::kPooled;
  }
}

std::vector<double> months_of(const v1::EstimateRetentionRequest& request, FieldViolations& violations) {
  std::vector<double> months(request.months().begin(), request.months().end());
  if (months.empty()) months = {1.0, 3.0, 6.0, 12.0};
  if (months.size() > kMostPoints) {
    violations.add("months", absl::StrCat("has ", months.size(), " times, at most ", kMostPoints));
  }
  for (size_t k = 0; k < months.size(); ++k) {
    violations.check_range(absl::StrCat("months[", k, "]"), months[k], 0.0, kMostMonths, "months");
  }
  return months;
}

/// The curve after a follow-up of so much injected fat.
forecast::Retention update(const forecast::Retention& prior, const v1::EstimateRetentionRequest& request,
                           FieldViolations& violations) {
  const forecast::FollowUp found = to_follow_up(request.follow_up(), violations);
  if (found.is_skin_volume) {
    violations.add("follow_up.skin_volume_ml", "needs a plan: MakeForecast finds the fat behind it");
  }
  const double injected = request.injected_ml() * kMl;
  if (!request.has_injected_ml() || !(injected > 0.0) || request.injected_ml() > kMostMl) {
    violations.add("injected_ml",
                   absl::StrCat("is ", request.injected_ml(), " mL, must be in (0, ", kMostMl, "] with a follow-up"));
    return prior;
  }
  forecast::check_follow_up("follow_up", found.month, found.volume, found.standard_error, injected, violations);
  if (!violations.empty()) return prior;
  return prior.updated_by({found.month, found.volume / injected, found.standard_error / injected});
}

}  // namespace

forecast::RetentionSpec to_retention_spec(const v1::Retention& message) {
  forecast::RetentionSpec spec;
  spec.preset = to_preset(message.preset());
  for (const v1::RetentionPoint& point : message.points()) spec.points.push_back({point.month(), point.share()});
  if (message.has_standard_deviation()) spec.spread = message.standard_deviation();
  return spec;
}

forecast::FollowUp to_follow_up(const v1::FollowUp& message, FieldViolations& violations) {
  forecast::FollowUp found;
  found.month = message.month();
  found.is_skin_volume = message.measured_case() == v1::FollowUp::kSkinVolumeMl;
  found.volume = (found.is_skin_volume ? message.skin_volume_ml() : message.kept_ml()) * kMl;
  found.standard_error = message.standard_error_ml() * kMl;
  if (message.measured_case() == v1::FollowUp::MEASURED_NOT_SET) {
    violations.add("follow_up", "measured nothing: kept_ml or skin_volume_ml is needed");
  }
  return found;
}

v1::RetentionEstimate to_estimate(const forecast::Retention& retention, const forecast::Retention& prior,
                                  const std::vector<double>& months) {
  v1::RetentionEstimate estimate;
  for (const double month : months) {
    v1::RetentionAtMonth& at = *estimate.add_months();
    at.set_month(month);
    at.set_mean(retention.mean(month));
    at.set_p05(retention.quantile(month, 0.05));
    at.set_p50(retention.quantile(month, 0.50));
    at.set_p95(retention.quantile(month, 0.95));
    at.set_prior_p05(prior.quantile(month, 0.05));
    at.set_prior_p50(prior.quantile(month, 0.50));
    at.set_prior_p95(prior.quantile(month, 0.95));
  }
  estimate.set_source(retention.source());
  estimate.set_updated(retention.is_updated());
  estimate.add_remarks(
      "Patients differ in one number, the share after 12 months; published intervals are those of means.");
  return estimate;
}

absl::StatusOr<v1::RetentionEstimate> estimate_retention(const v1::EstimateRetentionRequest& request) {
  FieldViolations violations;
  const auto prior = forecast::Retention::create(to_retention_spec(request.retention()));
  violations.absorb("retention", prior.status());
  const std::vector<double> months = months_of(request, violations);
  if (request.has_wanted_ml()) violations.check_range("wanted_ml", request.wanted_ml(), 0.0, kMostMl, "mL");
  if (request.has_injected_ml() && !request.has_follow_up()) {
    violations.check_range("injected_ml", request.injected_ml(), 0.0, kMostMl, "mL");
  }
  if (!prior.ok()) return violations.to_status();
  const forecast::Retention retention = request.has_follow_up() ? update(*prior, request, violations) : *prior;
  if (!violations.empty()) return violations.to_status();
  v1::RetentionEstimate estimate = to_estimate(retention, *prior, months);
  if (request.has_wanted_ml()) {
    const double last = months.back();
    const auto inject = [&](double part) {
      return forecast::volume_to_inject(retention, last, request.wanted_ml(), part);
    };
    estimate.set_inject_ml(inject(0.5));
    estimate.set_inject_low_ml(inject(0.05));
    estimate.set_inject_high_ml(inject(0.95));
  }
  return estimate;
}

}  // namespace lipofill::server
