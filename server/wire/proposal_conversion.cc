#include "server/wire/proposal_conversion.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/base/units.h"
#include "server/wire/report_conversion.h"
#include "server/wire/simulation_conversion.h"

namespace lipofill::server {
namespace {

using planning::Bound;

/// Volumes are whole thousandths of a millilitre, which division by 1e-6 misses in the last bit.
double to_ml(double volume) {
  return std::round(1000.0 * (volume / kCubicMetresPerMillilitre)) / 1000.0;
}

double in_ml(double volume) {
  return volume / kCubicMetresPerMillilitre;
}

/// A bound that a message may have, at least 0.
void read_bound(bool is_given, double value, double unit, const std::string& field, const char* unit_name,
                double& bound, FieldViolations& violations) {
  if (!is_given) return;
  violations.check_range(field, value, 0.0, 1e6, unit_name);
  bound = value * unit;
}

planning::ProposalBounds read_bounds(const v1::ProposalBounds& message, FieldViolations& violations) {
  planning::ProposalBounds bounds;
  constexpr double kMl = kCubicMetresPerMillilitre;
  read_bound(message.has_min_zone_ml(), message.min_zone_ml(), kMl, "bounds.min_zone_ml", "mL", bounds.each_zone.low,
             violations);
  read_bound(message.has_max_zone_ml(), message.max_zone_ml(), kMl, "bounds.max_zone_ml", "mL", bounds.each_zone.high,
             violations);
  read_bound(message.has_max_total_ml(), message.max_total_ml(), kMl, "bounds.max_total_ml", "mL", bounds.max_total,
             violations);
  read_bound(message.has_max_pressure_pa(), message.max_pressure_pa(), 1.0, "bounds.max_pressure_pa", "Pa",
             bounds.max_pressure, violations);
  read_bound(message.has_max_lift_mm(), message.max_lift_mm(), kMetresPerMillimetre, "bounds.max_lift_mm", "mm",
             bounds.max_lift, violations);
  for (int k = 0; k < message.zone_bounds_size(); ++k) {
    const v1::ZoneBounds& zone = message.zone_bounds(k);
    const std::string field = absl::StrCat("bounds.zone_bounds[", k, "]");
    if (bounds.zones.contains(zone.zone())) violations.add(field + ".zone", "is '" + zone.zone() + "' again");
    planning::VolumeRange range = bounds.each_zone;
    read_bound(zone.has_min_ml(), zone.min_ml(), kMl, field + ".min_ml", "mL", range.low, violations);
    read_bound(zone.has_max_ml(), zone.max_ml(), kMl, field + ".max_ml", "mL", range.high, violations);
    bounds.zones[zone.zone()] = range;
  }
  return bounds;
}

planning::ZoneProposals read_zones(const v1::ZoneProposals& message, FieldViolations& violations) {
  planning::ZoneProposals zones;
  zones.below_layers.assign(message.below_layers().begin(), message.below_layers().end());
  if (message.has_max_zones()) {
    violations.check_range("zones.max_zones", message.max_zones(), 1, 12, "");
    zones.max_zones = static_cast<int>(message.max_zones());
  }
  if (message.has_min_deficit_mm()) {
    violations.check_range("zones.min_deficit_mm", message.min_deficit_mm(), 0.1, 20.0, "mm");
    zones.min_deficit = message.min_deficit_mm() * kMetresPerMillimetre;
  }
  return zones;
}

planning::TissueSpread read_spread(const v1::TissueSpread& message, FieldViolations& violations) {
  planning::TissueSpread spread;
  violations.check_range("spread.pressure_band_pa", message.pressure_band_pa(), 1.0, 1e6, "Pa");
  spread.pressure_band = message.pressure_band_pa();
  if (message.has_share()) {
    violations.check_range("spread.share", message.share(), 0.5, 0.99, "");
    spread.share = message.share();
  }
  if (message.has_members()) {
    violations.check_range("spread.members", message.members(), 20, 1000, "");
    spread.members = static_cast<int>(message.members());
  }
  if (message.has_modulus_spread()) {
    violations.check_range("spread.modulus_spread", message.modulus_spread(), 1e-3, 0.5, "");
    spread.modulus_spread = message.modulus_spread();
  }
  return spread;
}

void set_robustness(const planning::Proposal& proposal, v1::Robustness& message) {
  const planning::Robustness& found = *proposal.robustness;
  message.set_members(static_cast<uint32_t>(found.members));
  message.set_members_below(static_cast<uint32_t>(found.members_below));
  message.set_pressure_quantile_pa(found.quantile);
  message.set_nominal_members_below(static_cast<uint32_t>(found.nominal_members_below));
  message.set_nominal_pressure_quantile_pa(found.nominal_quantile);
  message.set_nominal_total_ml(to_ml(found.nominal.total()));
  message.set_nominal_rms_mm(proposal.nominal_rms * kMillimetresPerMetre);
}

const char* to_field(Bound bound) {
  switch (bound) {
    case Bound::kMinZone:
      return "min_zone_ml";
    case Bound::kMaxZone:
      return "max_zone_ml";
    case Bound::kMaxTotal:
      return "max_total_ml";
    case Bound::kMaxPressure:
      return "max_pressure_pa";
    case Bound::kMaxLift:
      return "max_lift_mm";
    case Bound::kPath:
      return "tissue";
    case Bound::kNone:
      break;
  }
  return "";
}

v1::Remainder::Cause to_cause(planning::Cause cause) {
  switch (cause) {
    case planning::Cause::kBound:
      return v1::Remainder::BOUND;
    case planning::Cause::kOutOfReach:
      return v1::Remainder::OUT_OF_REACH;
    case planning::Cause::kStiffness:
      return v1::Remainder::STIFFNESS;
    case planning::Cause::kAboveTarget:
      return v1::Remainder::ABOVE_TARGET;
  }
  return v1::Remainder::CAUSE_UNSPECIFIED;
}

v1::SurfaceComparison to_comparison(const planning::Closeness& closeness) {
  v1::SurfaceComparison message;
  *message.mutable_skin_to_target() = to_distance_statistics(closeness.skin_to_target);
  message.mutable_skin_to_target()->set_signed_mean_mm(closeness.skin_to_target.signed_mean * kMillimetresPerMetre);
  *message.mutable_target_to_skin() = to_distance_statistics(closeness.target_to_skin);
  message.set_hausdorff_mm(std::max(message.skin_to_target().max_mm(), message.target_to_skin().max_mm()));
  message.mutable_volume()->set_deficit_ml(in_ml(closeness.volume.deficit));
  message.mutable_volume()->set_excess_ml(in_ml(closeness.volume.excess));
  message.set_skin_vertices(static_cast<uint32_t>(closeness.skin_vertices));
  return message;
}

void set_volume(const planning::ProposedVolume& volume, v1::ProposedVolume& message) {
  message.set_zone(volume.zone);
  message.set_below_layer(volume.below_layer);
  message.set_volume_ml(to_ml(volume.volume));
  message.set_pressure_pa(volume.pressure);
  message.set_standard_error_ml(in_ml(volume.standard_error));
  message.set_bound(to_field(volume.bound));
  message.set_proposed_zone(volume.is_proposed);
}

void set_trade_off(const planning::Proposal& proposal, const planning::TradeOff& point, v1::TradeOff& message) {
  for (size_t z = 0; z < proposal.volumes.size(); ++z) {
    planning::ProposedVolume volume = proposal.volumes[z];
    const auto k = static_cast<Eigen::Index>(z);
    volume.volume = point.volumes[k];
    volume.pressure = point.pressure[k];
    volume.bound = point.bound[z];
    set_volume(volume, *message.add_volumes());
    message.mutable_volumes()->rbegin()->clear_standard_error_ml();
  }
  message.set_total_ml(to_ml(point.total()));
  message.set_max_pressure_pa(point.max_pressure());
  message.set_rms_mm(point.rms * kMillimetresPerMetre);
  message.set_p95_mm(point.p95 * kMillimetresPerMetre);
}

void set_painted(const plan::ZoneSpec& zone, v1::Zone& message) {
  message.set_name(zone.name);
  const geometry::ScalarField& cover = std::get<plan::PaintedRegion>(zone.shape).cover;
  message.mutable_painted()->set_n_xi(static_cast<uint32_t>(cover.n_xi));
  message.mutable_painted()->set_n_eta(static_cast<uint32_t>(cover.n_eta));
  message.mutable_painted()->mutable_values()->Add(cover.values.begin(), cover.values.end());
}

/// Takes the films of the plan to those of the proposal: zones that were left out go, those that
/// were proposed come.
void edit_films(const plan::SimulationSpec& proposed, v1::SimulationSpec& plan) {
  google::protobuf::RepeatedPtrField<v1::Film> films;
  for (const plan::FilmSpec& film : proposed.films) {
    const auto own = std::find_if(plan.films().begin(), plan.films().end(),
                                  [&](const v1::Film& other) { return other.name() == film.name; });
    v1::Film& message = *films.Add();
    if (own != plan.films().end()) message = *own;
    message.set_name(film.name);
    message.set_below_layer(film.below_layer);
    message.clear_zones();
    for (const plan::ZoneSpec& zone : film.zones) {
      v1::Zone& to = *message.add_zones();
      const bool is_new =
          own == plan.films().end() || std::none_of(own->zones().begin(), own->zones().end(),
                                                    [&](const v1::Zone& other) { return other.name() == zone.name; });
      if (is_new) {
        set_painted(zone, to);
        continue;
      }
      to = *std::find_if(own->zones().begin(), own->zones().end(),
                         [&](const v1::Zone& other) { return other.name() == zone.name; });
    }
  }
  *plan.mutable_films() = std::move(films);
}

void edit_injections(const plan::SimulationSpec& proposed, v1::SimulationSpec& plan) {
  google::protobuf::RepeatedPtrField<v1::Injection> injections;
  for (const plan::InjectionSpec& injection : proposed.injections) {
    const auto own = std::find_if(plan.injections().begin(), plan.injections().end(),
                                  [&](const v1::Injection& other) { return other.zone() == injection.zone; });
    v1::Injection& message = *injections.Add();
    if (own != plan.injections().end()) message = *own;
    message.set_zone(injection.zone);
    message.set_volume_ml(to_ml(injection.volume));
    message.clear_start_s();
    if (own == plan.injections().end()) message.set_rate_ml_per_s(in_ml(injection.rate));
  }
  *plan.mutable_injections() = std::move(injections);
}

}  // namespace

absl::StatusOr<planning::ProposalRequest> to_proposal_request(const v1::ProposalSpec& spec) {
  FieldViolations violations;
  planning::ProposalRequest request;
  if (!spec.has_plan()) violations.add("plan", "is missing");
  auto plan = to_simulation_spec(spec.plan());
  if (spec.has_plan()) violations.absorb("plan", plan.status());
  if (plan.ok()) request.plan = *std::move(plan);
  request.bounds = read_bounds(spec.bounds(), violations);
  if (spec.has_zones()) {
    request.zones = read_zones(spec.zones(), violations);
    request.min_deficit = request.zones->min_deficit;
  }
  if (spec.has_worthwhile_mm()) {
    violations.check_range("worthwhile_mm", spec.worthwhile_mm(), 0.0, 10.0, "mm");
    request.worthwhile = spec.worthwhile_mm() * kMetresPerMillimetre;
  }
  if (spec.has_curve_points()) {
    violations.check_range("curve_points", spec.curve_points(), 1, 20, "");
    request.curve_points = static_cast<int>(spec.curve_points());
  }
  if (spec.has_max_solves()) {
    violations.check_range("max_solves", spec.max_solves(), 1, 10'000, "");
    request.max_solves = static_cast<int>(spec.max_solves());
  }
  if (spec.has_spread()) request.spread = read_spread(spec.spread(), violations);
  if (violations.empty()) {
    const auto number = request.zones ? planning::ZoneNumber::kSought : planning::ZoneNumber::kFixed;
    violations.absorb("", planning::check_bounds(request.bounds, request.plan, number));
  }
  if (!violations.empty()) return violations.to_status();
  return request;
}

v1::Proposal to_proposal(const v1::ProposalSpec& spec, const planning::Proposal& proposal) {
  v1::Proposal message;
  *message.mutable_plan() = spec.plan();
  edit_films(proposal.plan, *message.mutable_plan());
  edit_injections(proposal.plan, *message.mutable_plan());
  message.mutable_plan()->mutable_time()->set_goal(v1::TimeControl::SETTLED_SHAPE);
  message.mutable_plan()->mutable_time()->set_end_s(proposal.plan.end);
  if (spec.plan().time().settle_skin_speed_mm_per_s() == 0.0) {
    message.mutable_plan()->mutable_time()->clear_settle_skin_speed_mm_per_s();
  }
  for (const planning::ProposedVolume& volume : proposal.volumes) set_volume(volume, *message.add_volumes());
  *message.mutable_before() = to_comparison(proposal.before);
  *message.mutable_reached() = to_comparison(proposal.reached);
  for (const planning::Remainder& remainder : proposal.remainders) {
    v1::Remainder& to = *message.add_remainders();
    to.set_place(remainder.zone);
    to.set_cause(to_cause(remainder.cause));
    to.mutable_volume()->set_deficit_ml(in_ml(remainder.volume.deficit));
    to.mutable_volume()->set_excess_ml(in_ml(remainder.volume.excess));
    to.set_rms_mm(remainder.rms * kMillimetresPerMetre);
    to.set_description(planning::describe_remainder(remainder));
  }
  message.set_total_ml(to_ml(proposal.total()));
  message.set_max_pressure_pa(proposal.max_pressure());
  message.set_max_lift_mm(proposal.max_lift * kMillimetresPerMetre);
  for (const planning::TradeOff& point : proposal.curve) set_trade_off(proposal, point, *message.add_curve());
  message.set_proposed_point(static_cast<uint32_t>(proposal.proposed_point));
  message.set_solves(static_cast<uint32_t>(proposal.cost.solves()));
  message.set_factorisations(static_cast<uint32_t>(proposal.cost.factorisations));
  message.set_state_hash(proposal.state_hash);
  for (const std::string& remark : proposal.remarks) message.add_remarks(remark);
  if (proposal.robustness) set_robustness(proposal, *message.mutable_robustness());
  return message;
}

}  // namespace lipofill::server
