#include "core/forecast/forecast.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/hash.h"
#include "core/base/units.h"
#include "core/forecast/figures.h"
#include "core/forecast/kept_volume.h"
#include "core/forecast/member_run.h"

namespace lipofill::forecast {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Lifts of every vertex are kept for their quantiles [values].
constexpr double kMostLifts = 1e8;
/// Fewer members than this share tell nothing of the others.
constexpr double kLeastSettled = 0.5;
constexpr size_t kMostReasons = 20;

/// A forecast on its way: each function is a step, in their order in make_forecast.
class Making {
 public:
  Making(const std::shared_ptr<const model::FaceModel>& model, const ForecastRequest& request,
         const geometry::Progress& progress)
      : model_(model), request_(request), progress_(progress) {
    months_.push_back(0.0);
    months_.insert(months_.end(), request.months.begin(), request.months.end());
  }

  absl::Status know_retention();
  absl::Status choose();
  absl::Status find_members(int workers, const KeptParts& kept);
  void summarise();
  absl::Status plan_volumes();
  void compare_grids();
  Forecast finish();

 private:
  absl::Status check_size() const;
  absl::Status check_settled();
  double planned_volume(const std::string& zone) const;
  const ForecastFigure& pressure_at_once(const std::string& zone) const;
  void remark();
  std::string hash() const;

  const std::shared_ptr<const model::FaceModel>& model_;
  const ForecastRequest& request_;
  const geometry::Progress& progress_;
  std::vector<double> months_;
  Forecast forecast_;
  Design design_;
  MemberTable table_;
  std::vector<std::string> zones_;
  std::vector<simulation::MemberShape> nominal_;
};

absl::Status Making::know_retention() {
  auto retention = Retention::create(request_.retention);
  if (!retention.ok()) {
    FieldViolations violations;
    violations.absorb("retention", retention.status());
    return violations.to_status();
  }
  forecast_.prior = *retention;
  forecast_.retention = *retention;
  if (!request_.follow_up) return absl::OkStatus();
  const auto kept = find_kept_share(model_, request_.plan, *request_.follow_up, *retention);
  if (!kept.ok()) return kept.status();
  forecast_.retention = retention->updated_by(*kept);
  return absl::OkStatus();
}

absl::Status Making::choose() {
  auto inputs = choose_inputs(model_->layers, request_.plan, request_.inputs, request_.only_named_inputs);
  if (!inputs.ok()) return inputs.status();
  forecast_.inputs = *std::move(inputs);
  forecast_.inputs.push_back(
      {Quantity::kRetention, "", forecast_.retention.at_12_months(), forecast_.retention.source(), true});
  return check_size();
}

absl::Status Making::check_size() const {
  if (request_.figures_only) return absl::OkStatus();
  const double values = static_cast<double>(model_->geometry.grid.nodes_per_level()) * months_.size();
  if (values * request_.members <= kMostLifts) return absl::OkStatus();
  return field_violation("members", absl::StrFormat("is %d, at most %d with the values of %d vertices at %d times; "
                                                    "figures_only leaves these out",
                                                    request_.members, static_cast<int>(kMostLifts / values),
                                                    model_->geometry.grid.nodes_per_level(), months_.size()));
}

absl::Status Making::find_members(int workers, const KeptParts& kept) {
  VectorXd nominal_kept(static_cast<Index>(months_.size()));
  for (size_t time = 0; time < months_.size(); ++time) {
    nominal_kept[static_cast<Index>(time)] = forecast_.retention.quantile(months_[time], 0.5);
  }
  auto ensemble = simulation::PlanEnsemble::create(model_, request_.plan, nominal_kept, workers);
  if (!ensemble.ok()) return ensemble.status();
  design_ = draw_design(forecast_.inputs, request_.members);
  auto table = run_members(**ensemble, *model_, request_.plan, forecast_.inputs, design_, forecast_.retention, months_,
                           !request_.figures_only, kept, progress_);
  if (!table.ok()) return table.status();
  table_ = *std::move(table);
  zones_ = (*ensemble)->zones();
  nominal_ = (*ensemble)->nominal();
  return check_settled();
}

absl::Status Making::check_settled() {
  forecast_.members = request_.members;
  forecast_.failed = request_.members - static_cast<int>(table_.settled.size());
  forecast_.failures = table_.failures;
  std::stable_sort(forecast_.failures.begin(), forecast_.failures.end(),
                   [](const MemberFailure& a, const MemberFailure& b) { return a.members > b.members; });
  if (forecast_.failures.size() > kMostReasons) forecast_.failures.resize(kMostReasons);
  if (static_cast<double>(table_.settled.size()) >= kLeastSettled * request_.members) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "%d of %d members settled, at least half have to; the most frequent reason, in %d of them: %s",
      table_.settled.size(), request_.members, forecast_.failures.front().members, forecast_.failures.front().reason));
}

/// Causes are told of the shape at once and of the last one.
void Making::summarise() {
  for (size_t time = 0; time < months_.size(); ++time) {
    forecast_.times.push_back(
        summarise_time(table_, time, months_[time], zones_, nominal_[time], !request_.figures_only));
    if (time > 0 && time + 1 < months_.size()) continue;
    if (progress_) progress_(1.0, "finding causes");
    add_influences(table_, time, design_, zones_, forecast_.times.back());
    const auto causes = describe_causes(forecast_.times.back(), forecast_.inputs);
    forecast_.causes.insert(forecast_.causes.end(), causes.begin(), causes.end());
  }
}

double Making::planned_volume(const std::string& zone) const {
  double volume = 0.0;
  for (const plan::InjectionSpec& injection : request_.plan.injections) {
    if (injection.zone == zone) volume += injection.volume;
  }
  return volume;
}

const ForecastFigure& Making::pressure_at_once(const std::string& zone) const {
  const auto& figures = forecast_.times.front().figures;
  return *std::find_if(figures.begin(), figures.end(), [&](const ForecastFigure& figure) {
    return figure.kind == FigureKind::kMeanPressure && figure.zone == zone;
  });
}

/// Finds how much to inject into the zones that are filled, and in how many sessions.
absl::Status Making::plan_volumes() {
  const Retention& retention = forecast_.retention;
  const double last = months_.back();
  std::vector<std::string> filled;
  for (const std::string& zone : zones_) {
    if (planned_volume(zone) > 0.0) filled.push_back(zone);
  }
  // A zone's pressure in one case of twenty grows with the volumes like the nominal one.
  VectorXd bounds(static_cast<Index>(filled.size()));
  for (size_t z = 0; z < filled.size(); ++z) {
    const ForecastFigure& pressure = pressure_at_once(filled[z]);
    const double share = pressure.nominal > 0.0 ? pressure.spread.p95 / pressure.nominal : 1.0;
    bounds[static_cast<Index>(z)] = request_.session_band / std::max(share, 1.0);
  }
  const auto multiples = find_largest_multiples(model_, request_.plan, filled, bounds);
  if (!multiples.ok()) return multiples.status();
  for (size_t z = 0; z < filled.size(); ++z) {
    ZoneForecast zone;
    zone.zone = filled[z];
    zone.planned = planned_volume(filled[z]);
    const auto wanted = request_.wanted.find(filled[z]);
    zone.wanted = wanted != request_.wanted.end() ? wanted->second : zone.planned;
    zone.remaining = zone.planned * retention.quantile(last, 0.5);
    zone.remaining_p05 = zone.planned * retention.quantile(last, 0.05);
    zone.remaining_p95 = zone.planned * retention.quantile(last, 0.95);
    zone.inject = volume_to_inject(retention, last, zone.wanted, 0.5);
    zone.inject_low = volume_to_inject(retention, last, zone.wanted, 0.05);
    zone.inject_high = volume_to_inject(retention, last, zone.wanted, 0.95);
    zone.most_at_once = (*multiples)[static_cast<Index>(z)] * zone.planned;
    forecast_.zones.push_back(std::move(zone));
  }
  if (!forecast_.zones.empty()) {
    forecast_.sessions = plan_sessions(retention, forecast_.zones, request_.months_between_sessions, last);
    if (forecast_.sessions.empty()) {
      forecast_.remarks.push_back(absl::StrFormat(
          "The wanted volumes are not reached in eight sessions below %.3g mmHg: the zones hold too little at once.",
          request_.session_band / 133.322));
    }
  }
  return absl::OkStatus();
}

void Making::compare_grids() {
  if (progress_) progress_(1.0, "comparing grids");
  forecast_.grid_error = estimate_grid_error(model_, request_.plan);
  if (!forecast_.grid_error.ok()) return;
  if (std::string remark = remark_on_order(*forecast_.grid_error); !remark.empty()) {
    forecast_.remarks.push_back(std::move(remark));
  }
}

void Making::remark() {
  auto& remarks = forecast_.remarks;
  if (forecast_.failed > 0) {
    remarks.push_back(absl::StrFormat("%d of %d members (%.1f %%) did not settle; all figures are those of the others.",
                                      forecast_.failed, forecast_.members,
                                      100.0 * forecast_.failed / forecast_.members));
  }
  const auto assumed = std::count_if(forecast_.inputs.begin(), forecast_.inputs.end(),
                                     [](const UncertainInput& input) { return input.is_assumed; });
  if (assumed > 0) {
    remarks.push_back(absl::StrFormat("%d of %d uncertain inputs have a spread that is assumed, in part or as a whole.",
                                      assumed, forecast_.inputs.size()));
  }
  remarks.push_back(
      "Fat is thought to leave every zone alike, and the tissue to stay as it was; viscosity does not change a shape "
      "at rest.");
}

/// Over all that a forecast tells.
std::string Making::hash() const {
  Hasher hasher;
  hasher.add("lipofill forecast 1");
  hasher.add(model_->content_hash);
  hasher.add(forecast_.members);
  hasher.add(forecast_.failed);
  for (const ForecastTime& time : forecast_.times) {
    hasher.add(time.month);
    for (const ForecastFigure& figure : time.figures) {
      const Spread& s = figure.spread;
      for (const double value : {figure.nominal, s.mean, s.standard_deviation, s.p05, s.p50, s.p95}) hasher.add(value);
      if (!figure.influences) continue;
      for (const Influence& influence : figure.influences->of_input) {
        hasher.add(influence.first_order);
        hasher.add(influence.total);
      }
    }
    hasher.add_bytes(time.mean_displacement.data(),
                     static_cast<size_t>(time.mean_displacement.size()) * sizeof(double));
    hasher.add_bytes(time.lift_p05.data(), static_cast<size_t>(time.lift_p05.size()) * sizeof(double));
    hasher.add_bytes(time.lift_p95.data(), static_cast<size_t>(time.lift_p95.size()) * sizeof(double));
  }
  for (const ZoneForecast& zone : forecast_.zones) {
    for (const double value : {zone.remaining, zone.inject, zone.inject_low, zone.inject_high, zone.most_at_once}) {
      hasher.add(value);
    }
  }
  if (forecast_.grid_error.ok()) {
    for (const double value :
         {forecast_.grid_error->lift, forecast_.grid_error->pressure, forecast_.grid_error->skin}) {
      hasher.add(value);
    }
  }
  return hasher.hex_digest();
}

Forecast Making::finish() {
  remark();
  forecast_.content_hash = hash();
  return std::move(forecast_);
}

}  // namespace

absl::StatusOr<Forecast> make_forecast(const std::shared_ptr<const model::FaceModel>& model,
                                       const ForecastRequest& request, int workers, const KeptParts& kept,
                                       const geometry::Progress& progress) {
  FieldViolations violations;
  check_request(request, violations);
  if (!violations.empty()) return violations.to_status();
  Making making(model, request, progress);
  if (auto status = making.know_retention(); !status.ok()) return status;
  if (auto status = making.choose(); !status.ok()) return status;
  if (auto status = making.find_members(workers, kept); !status.ok()) return status;
  making.summarise();
  if (auto status = making.plan_volumes(); !status.ok()) return status;
  making.compare_grids();
  return making.finish();
}

}  // namespace lipofill::forecast
