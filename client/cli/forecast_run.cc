#include "client/cli/forecast_run.h"

#include <filesystem>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"
#include "client/cpp/json_file.h"
#include "client/cpp/json_message.h"
#include "client/cpp/model_build.h"
#include "lipofill/v1/forecast_service.grpc.pb.h"

namespace lipofill::client {
namespace {

void append_figure(const v1::ForecastFigure& figure, std::string& text) {
  absl::StrAppendFormat(&text, "  %-14s %-20s %9.3f %-3s  90 of 100 from %.3f to %.3f\n", figure.name(), figure.zone(),
                        figure.p50(), figure.unit(), figure.p05(), figure.p95());
}

void append_bands(const v1::PressureBands& bands, std::string& text) {
  absl::StrAppendFormat(&text,
                        "  pressure bands %-19s below 9 mmHg %.0f %%, 9-15 %.0f %%, 15-30 %.0f %%, above %.0f %%\n",
                        bands.zone(), 100.0 * bands.below_9_mmhg(), 100.0 * bands.from_9_to_15_mmhg(),
                        100.0 * bands.from_15_to_30_mmhg(), 100.0 * bands.above_30_mmhg());
}

void append_zone(const v1::ZoneVolumeForecast& zone, std::string& text) {
  absl::StrAppendFormat(
      &text, "zone %s: of %.2f mL remain %.2f (%.2f-%.2f); so that %.2f remain inject %.2f (%.2f-%.2f) mL", zone.zone(),
      zone.planned_ml(), zone.remaining_ml(), zone.remaining_p05_ml(), zone.remaining_p95_ml(), zone.wanted_ml(),
      zone.inject_ml(), zone.inject_low_ml(), zone.inject_high_ml());
  if (zone.has_most_at_once_ml()) absl::StrAppendFormat(&text, ", at most %.2f at once", zone.most_at_once_ml());
  text += "\n";
}

void append_grid_error(const v1::GridError& error, std::string& text) {
  if (!error.has_lift_share()) {
    absl::StrAppend(&text, "error of the grid: not known: ", error.reason(), "\n");
    return;
  }
  absl::StrAppendFormat(&text,
                        "error of the grid: lift %.1f %%, pressure %.1f %%, skin %.3f mm at 95 of 100 places%s\n",
                        100.0 * error.lift_share(), 100.0 * error.pressure_share(), error.skin_mm(),
                        error.order_holds() ? "" : " (a plain difference: no order was seen)");
}

void append_sessions(const v1::Forecast& forecast, std::string& text) {
  for (int k = 0; k < forecast.sessions_size(); ++k) {
    const v1::PlannedSession& session = forecast.sessions(k);
    absl::StrAppendFormat(&text, "session %d, month %.3g:", k + 1, session.month());
    for (int z = 0; z < session.inject_ml_size() && z < forecast.zones_size(); ++z) {
      absl::StrAppendFormat(&text, " %s %.2f mL", forecast.zones(z).zone(), session.inject_ml(z));
    }
    text += "\n";
  }
}

}  // namespace

std::string describe(const v1::RetentionEstimate& estimate) {
  std::string text = absl::StrCat("retention: ", estimate.source(), "\n");
  for (const v1::RetentionAtMonth& at : estimate.months()) {
    absl::StrAppendFormat(&text, "  month %4.3g  %.0f %% left, 90 of 100 from %.0f to %.0f %%\n", at.month(),
                          100.0 * at.p50(), 100.0 * at.p05(), 100.0 * at.p95());
  }
  if (estimate.has_inject_ml()) {
    absl::StrAppendFormat(&text, "inject %.2f mL (%.2f-%.2f)\n", estimate.inject_ml(), estimate.inject_low_ml(),
                          estimate.inject_high_ml());
  }
  return text;
}

std::string describe(const v1::Forecast& forecast) {
  std::string text =
      absl::StrFormat("%d of %d members settled\n", forecast.members() - forecast.failed_members(), forecast.members());
  for (const v1::MemberFailure& failure : forecast.failures()) {
    absl::StrAppendFormat(&text, "failed: %d, first %d: %s\n", failure.members(), failure.first_member(),
                          failure.reason());
  }
  for (const v1::ForecastTime& time : forecast.times()) {
    text += time.month() == 0.0 ? "at once\n" : absl::StrFormat("after %.3g months\n", time.month());
    for (const v1::ForecastFigure& figure : time.figures()) append_figure(figure, text);
    for (const v1::PressureBands& bands : time.bands()) append_bands(bands, text);
  }
  append_grid_error(forecast.grid_error(), text);
  for (const std::string& cause : forecast.causes()) absl::StrAppend(&text, cause, "\n");
  absl::StrAppend(&text, describe(forecast.retention()));
  for (const v1::ZoneVolumeForecast& zone : forecast.zones()) append_zone(zone, text);
  append_sessions(forecast, text);
  for (const std::string& remark : forecast.remarks()) absl::StrAppend(&text, "remark: ", remark, "\n");
  absl::StrAppendFormat(&text, "%.1f s; research and planning aid, not a medical device\n", forecast.wall_s());
  return text;
}

ForecastRun::ForecastRun(Application& application, ForecastOptions options)
    : PlanWork(application, options), options_(std::move(options)) {}

absl::Status ForecastRun::check_input() {
  if (!options_.settings.empty()) {
    if (auto loaded = load_message(options_.settings, &spec_); !loaded.ok()) return loaded;
  }
  spec_.MergeFrom(options_.spec);
  return absl::OkStatus();
}

absl::Status ForecastRun::work() {
  v1::MakeForecastRequest request;
  request.set_parent(ground_.patient());
  *request.mutable_spec() = spec_;
  *request.mutable_spec()->mutable_plan() = ground_.plan().plan.simulation();
  request.mutable_spec()->mutable_plan()->set_model(ground_.model().name());
  auto operation = ground_.connection().call<v1::ForecastService>(&v1::ForecastService::Stub::MakeForecast, request);
  if (!operation.ok()) return operation.status();
  return finish_operation(
      ground_.connection(), *operation,
      [this](const std::string& stage, double fraction) {
        progress_.show(absl::StrFormat("forecasting: %.0f %%  %s", 100.0 * fraction, stage));
      },
      &forecast_);
}

absl::Status ForecastRun::write_results() const {
  return write_text_file(std::filesystem::path(options_.out) / "forecast.json", message_json(forecast_));
}

std::string ForecastRun::json() const {
  return message_json(forecast_);
}

std::string ForecastRun::text() const {
  return absl::StrCat(describe(forecast_), "forecast.json in ", options_.out, "\n");
}

/// Options and a file of settings both fill the spec: its own names are those of the file.
std::string ForecastRun::option_of(const std::string& field) const {
  if (absl::StartsWith(field, "spec.plan.")) return absl::StrCat("simulation.", absl::StripPrefix(field, "spec.plan."));
  return field == "spec.members" ? "--members" : field;
}

}  // namespace lipofill::client
