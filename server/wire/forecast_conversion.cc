#include "server/wire/forecast_conversion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "server/wire/grid_error_conversion.h"
#include "server/wire/retention_conversion.h"
#include "server/wire/simulation_conversion.h"

namespace lipofill::server {
namespace {

using forecast::Distribution;
using forecast::FigureKind;
using forecast::Law;
using forecast::Quantity;

constexpr double kMl = kCubicMetresPerMillilitre;
constexpr double kPascalsPerMmhg = 133.322;
/// Influences below this are left out.
constexpr double kLeastInfluence = 0.005;

/// Places are lengths; everything else is a multiple or a share.
double unit_of(Quantity quantity) {
  return quantity == Quantity::kPlaceXi || quantity == Quantity::kPlaceEta ? kMetresPerMillimetre : 1.0;
}

Quantity to_quantity(v1::UncertainInput::Quantity quantity, const std::string& field, FieldViolations& violations) {
  switch (quantity) {
    case v1::UncertainInput::LAYER_MODULUS:
      return Quantity::kLayerModulus;
    case v1::UncertainInput::LAYER_THICKNESS:
      return Quantity::kLayerThickness;
    case v1::UncertainInput::ZONE_VOLUME:
      return Quantity::kZoneVolume;
    case v1::UncertainInput::PLACE_XI:
      return Quantity::kPlaceXi;
    case v1::UncertainInput::PLACE_ETA:
      return Quantity::kPlaceEta;
    case v1::UncertainInput::RETENTION:
      return Quantity::kRetention;
    default:
      violations.add(field, "is missing");
      return Quantity::kZoneVolume;
  }
}

v1::UncertainInput::Quantity to_message(Quantity quantity) {
  switch (quantity) {
    case Quantity::kLayerModulus:
      return v1::UncertainInput::LAYER_MODULUS;
    case Quantity::kLayerThickness:
      return v1::UncertainInput::LAYER_THICKNESS;
    case Quantity::kZoneVolume:
      return v1::UncertainInput::ZONE_VOLUME;
    case Quantity::kPlaceXi:
      return v1::UncertainInput::PLACE_XI;
    case Quantity::kPlaceEta:
      return v1::UncertainInput::PLACE_ETA;
    case Quantity::kRetention:
      break;
  }
  return v1::UncertainInput::RETENTION;
}

/// Ends that are not given lie three spreads away for laws with a spread; the others need theirs.
Distribution to_distribution(const v1::Distribution& message, double unit, const std::string& field,
                             FieldViolations& violations) {
  const double nothing = std::nan("");
  const double centre = message.has_centre() ? message.centre() * unit : nothing;
  Distribution distribution;
  switch (message.law()) {
    case v1::Distribution::NORMAL:
      distribution = Distribution::normal(centre, message.spread() * unit);
      break;
    case v1::Distribution::LOG_NORMAL:
      distribution = Distribution::log_normal(centre, message.spread());
      break;
    case v1::Distribution::UNIFORM:
      distribution = {Law::kUniform, 0.0, 0.0, nothing, nothing};
      break;
    case v1::Distribution::TRIANGULAR:
      distribution = {Law::kTriangular, centre, 0.0, nothing, nothing};
      break;
    default:
      violations.add(field + ".law", "is missing");
  }
  if (message.has_low()) distribution.low = message.low() * unit;
  if (message.has_high()) distribution.high = message.high() * unit;
  return distribution;
}

void set_distribution(const Distribution& distribution, double unit, v1::Distribution& message) {
  switch (distribution.law) {
    case Law::kNormal:
      message.set_law(v1::Distribution::NORMAL);
      break;
    case Law::kLogNormal:
      message.set_law(v1::Distribution::LOG_NORMAL);
      break;
    case Law::kUniform:
      message.set_law(v1::Distribution::UNIFORM);
      break;
    case Law::kTriangular:
      message.set_law(v1::Distribution::TRIANGULAR);
      break;
  }
  if (distribution.law != Law::kUniform) message.set_centre(distribution.centre / unit);
  if (distribution.is_gaussian()) {
    message.set_spread(distribution.law == Law::kNormal ? distribution.spread / unit : distribution.spread);
  }
  message.set_low(distribution.low / unit);
  message.set_high(distribution.high / unit);
}

std::vector<forecast::UncertainInput> read_inputs(const v1::ForecastSpec& spec, FieldViolations& violations) {
  std::vector<forecast::UncertainInput> inputs;
  for (int k = 0; k < spec.inputs_size(); ++k) {
    const v1::UncertainInput& message = spec.inputs(k);
    const std::string field = absl::StrCat("inputs[", k, "]");
    forecast::UncertainInput input;
    input.quantity = to_quantity(message.quantity(), field + ".quantity", violations);
    input.name = message.name();
    input.distribution =
        to_distribution(message.distribution(), unit_of(input.quantity), field + ".distribution", violations);
    input.source = message.source().empty() ? "as given" : message.source();
    input.is_assumed = message.assumed();
    inputs.push_back(std::move(input));
  }
  return inputs;
}

/// A unit says what a figure is called, its unit, and how many SI units that is.
struct FigureUnit {
  const char* name;
  const char* unit;
  double size;
};

FigureUnit unit_of(FigureKind kind) {
  switch (kind) {
    case FigureKind::kMaxLift:
      return {"max_lift", "mm", kMetresPerMillimetre};
    case FigureKind::kSkinVolume:
      return {"skin_volume", "mL", kMl};
    case FigureKind::kMeanPressure:
      return {"mean_pressure", "Pa", 1.0};
    case FigureKind::kVolume:
      break;
  }
  return {"volume", "mL", kMl};
}

void set_influences(const forecast::Influences& influences, v1::ForecastFigure& message) {
  message.set_unexplained_share(influences.unexplained);
  if (influences.unexplained > 0.1) return;
  std::vector<v1::Influence> told;
  for (size_t k = 0; k < influences.of_input.size(); ++k) {
    const forecast::Influence& influence = influences.of_input[k];
    if (influence.total < kLeastInfluence) continue;
    v1::Influence& to = told.emplace_back();
    to.set_input(static_cast<uint32_t>(k));
    to.set_first_order(influence.first_order);
    to.set_total(influence.total);
    to.set_first_order_error(influence.first_order_error);
    to.set_total_error(influence.total_error);
  }
  std::stable_sort(told.begin(), told.end(),
                   [](const v1::Influence& a, const v1::Influence& b) { return a.total() > b.total(); });
  for (v1::Influence& influence : told) *message.add_influences() = std::move(influence);
}

void set_figure(const forecast::ForecastFigure& figure, v1::ForecastFigure& message) {
  const FigureUnit unit = unit_of(figure.kind);
  message.set_name(unit.name);
  message.set_zone(figure.zone);
  message.set_unit(unit.unit);
  message.set_nominal(figure.nominal / unit.size);
  message.set_mean(figure.spread.mean / unit.size);
  message.set_standard_deviation(figure.spread.standard_deviation / unit.size);
  message.set_p05(figure.spread.p05 / unit.size);
  message.set_p50(figure.spread.p50 / unit.size);
  message.set_p95(figure.spread.p95 / unit.size);
  if (figure.influences) set_influences(*figure.influences, message);
}

void set_time(const forecast::ForecastTime& time, int members, v1::ForecastTime& message) {
  message.set_month(time.month);
  message.set_members(static_cast<uint32_t>(members));
  for (const forecast::ForecastFigure& figure : time.figures) set_figure(figure, *message.add_figures());
  for (const forecast::PressureBands& bands : time.bands) {
    v1::PressureBands& to = *message.add_bands();
    to.set_zone(bands.zone);
    to.set_below_9_mmhg(bands.probability[0]);
    to.set_from_9_to_15_mmhg(bands.probability[1]);
    to.set_from_15_to_30_mmhg(bands.probability[2]);
    to.set_above_30_mmhg(bands.probability[3]);
  }
  for (const double value : time.mean_displacement.reshaped()) {
    message.add_mean_displacement_mm(static_cast<float>(value * kMillimetresPerMetre));
  }
  for (const double value : time.lift_p05) message.add_lift_p05_mm(static_cast<float>(value * kMillimetresPerMetre));
  for (const double value : time.lift_p95) message.add_lift_p95_mm(static_cast<float>(value * kMillimetresPerMetre));
}

void set_zone(const forecast::ZoneForecast& zone, v1::ZoneVolumeForecast& message) {
  message.set_zone(zone.zone);
  message.set_planned_ml(zone.planned / kMl);
  message.set_remaining_ml(zone.remaining / kMl);
  message.set_remaining_p05_ml(zone.remaining_p05 / kMl);
  message.set_remaining_p95_ml(zone.remaining_p95 / kMl);
  message.set_wanted_ml(zone.wanted / kMl);
  message.set_inject_ml(zone.inject / kMl);
  message.set_inject_low_ml(zone.inject_low / kMl);
  message.set_inject_high_ml(zone.inject_high / kMl);
  if (std::isfinite(zone.most_at_once)) message.set_most_at_once_ml(zone.most_at_once / kMl);
}

}  // namespace

absl::StatusOr<forecast::ForecastRequest> to_forecast_request(const v1::ForecastSpec& spec) {
  FieldViolations violations;
  forecast::ForecastRequest request;
  if (!spec.has_plan()) violations.add("plan", "is missing");
  auto plan = to_simulation_spec(spec.plan());
  if (spec.has_plan()) violations.absorb("plan", plan.status());
  if (plan.ok()) request.plan = *std::move(plan);
  if (spec.has_members())
    request.members = static_cast<int>(std::min<uint32_t>(spec.members(), std::numeric_limits<int>::max()));
  request.inputs = read_inputs(spec, violations);
  request.only_named_inputs = spec.only_named_inputs();
  request.retention = to_retention_spec(spec.retention());
  violations.absorb("retention", forecast::Retention::create(request.retention).status());
  if (spec.months_size() > 0) request.months.assign(spec.months().begin(), spec.months().end());
  if (spec.has_follow_up()) request.follow_up = to_follow_up(spec.follow_up(), violations);
  for (const v1::WantedVolume& wanted : spec.wanted()) request.wanted[wanted.zone()] = wanted.volume_ml() * kMl;
  const double band = spec.has_session_band_mmhg() ? spec.session_band_mmhg() : 30.0;
  violations.check_range("session_band_mmhg", band, 1.0, 100.0, "mmHg");
  request.session_band = band * kPascalsPerMmhg;
  if (spec.has_months_between_sessions()) request.months_between_sessions = spec.months_between_sessions();
  violations.check_range("months_between_sessions", request.months_between_sessions, 1.0, 24.0, "months");
  request.figures_only = spec.figures_only();
  if (plan.ok()) forecast::check_request(request, violations);
  if (!violations.empty()) return violations.to_status();
  return request;
}

v1::Forecast to_forecast_inputs(const std::vector<forecast::UncertainInput>& inputs) {
  v1::Forecast message;
  for (const forecast::UncertainInput& input : inputs) {
    v1::UncertainInput& to = *message.add_inputs();
    to.set_quantity(to_message(input.quantity));
    to.set_name(input.name);
    set_distribution(input.distribution, unit_of(input.quantity), *to.mutable_distribution());
    to.set_source(input.source);
    to.set_assumed(input.is_assumed);
  }
  return message;
}

v1::Forecast to_forecast(const forecast::Forecast& forecast) {
  v1::Forecast message = to_forecast_inputs(forecast.inputs);
  message.set_members(static_cast<uint32_t>(forecast.members));
  message.set_failed_members(static_cast<uint32_t>(forecast.failed));
  for (const forecast::MemberFailure& failure : forecast.failures) {
    v1::MemberFailure& to = *message.add_failures();
    to.set_reason(failure.reason);
    to.set_members(static_cast<uint32_t>(failure.members));
    to.set_first_member(static_cast<uint32_t>(failure.first));
  }
  std::vector<double> months;
  for (const forecast::ForecastTime& time : forecast.times) {
    set_time(time, forecast.members - forecast.failed, *message.add_times());
    if (time.month > 0.0) months.push_back(time.month);
  }
  message.mutable_causes()->Add(forecast.causes.begin(), forecast.causes.end());
  *message.mutable_retention() = to_estimate(forecast.retention, forecast.prior, months);
  for (const forecast::ZoneForecast& zone : forecast.zones) set_zone(zone, *message.add_zones());
  for (const forecast::Session& session : forecast.sessions) {
    v1::PlannedSession& to = *message.add_sessions();
    to.set_month(session.month);
    for (const double volume : session.inject) to.add_inject_ml(volume / kMl);
    for (const double volume : session.present) to.add_present_ml(volume / kMl);
  }
  *message.mutable_grid_error() = to_grid_error(forecast.grid_error);
  message.mutable_remarks()->Add(forecast.remarks.begin(), forecast.remarks.end());
  message.set_content_hash(forecast.content_hash);
  return message;
}

}  // namespace lipofill::server
