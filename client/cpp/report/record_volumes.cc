#include "client/cpp/report/record_volumes.h"

#include <algorithm>
#include <string>
#include <vector>

namespace lipofill::client {
namespace {

using nlohmann::ordered_json;

/// The layer below which the film of a zone lies.
std::string plane_of(const v1::SimulationSpec& spec, const std::string& name) {
  for (const v1::Film& film : spec.films()) {
    for (const v1::Zone& zone : film.zones()) {
      if (zone.name() == name) return film.below_layer();
    }
  }
  return "";
}

/// Lists what the plan puts into each zone, in the order of its injections.
std::vector<v1::ZoneVolumeForecast> planned_zones(const v1::SimulationSpec& spec,
                                                  const v1::RetentionAtMonth& retention) {
  std::vector<v1::ZoneVolumeForecast> zones;
  for (const v1::Injection& injection : spec.injections()) {
    auto found = std::find_if(zones.begin(), zones.end(),
                              [&](const v1::ZoneVolumeForecast& zone) { return zone.zone() == injection.zone(); });
    if (found == zones.end()) {
      found = zones.emplace(zones.end());
      found->set_zone(injection.zone());
    }
    found->set_planned_ml(found->planned_ml() + injection.volume_ml());
  }
  for (v1::ZoneVolumeForecast& zone : zones) {
    zone.set_remaining_ml(zone.planned_ml() * retention.p50());
    zone.set_remaining_p05_ml(zone.planned_ml() * retention.p05());
    zone.set_remaining_p95_ml(zone.planned_ml() * retention.p95());
  }
  return zones;
}

ordered_json record_of_zones(const ReportAnswers& answers, const std::vector<v1::ZoneVolumeForecast>& zones,
                             double prepare) {
  auto record = ordered_json::array();
  for (const v1::ZoneVolumeForecast& zone : zones) {
    record.push_back({{"zone", zone.zone()},
                      {"below_layer", plane_of(answers.plan.simulation(), zone.zone())},
                      {"prepare_ml", prepare * zone.planned_ml()},
                      {"inject_ml", zone.planned_ml()},
                      {"remaining_ml", zone.remaining_ml()},
                      {"remaining_p05_ml", zone.remaining_p05_ml()},
                      {"remaining_p95_ml", zone.remaining_p95_ml()}});
  }
  return record;
}

/// Sums over zones. Intervals do not add up and have none.
ordered_json total_of(const ordered_json& zones, const std::vector<std::string>& keys) {
  ordered_json total;
  for (const std::string& key : keys) {
    double sum = 0.0;
    for (const ordered_json& zone : zones) sum += zone.at(key).get<double>();
    total[key] = sum;
  }
  return total;
}

ordered_json record_of_sessions(const ReportAnswers& answers, double prepare) {
  auto record = ordered_json::array();
  for (const v1::PlannedSession& session : answers.forecast->sessions()) {
    auto zones = ordered_json::array();
    for (int z = 0; z < session.inject_ml_size() && z < answers.forecast->zones_size(); ++z) {
      const std::string& zone = answers.forecast->zones(z).zone();
      zones.push_back({{"zone", zone},
                       {"below_layer", plane_of(answers.plan.simulation(), zone)},
                       {"prepare_ml", prepare * session.inject_ml(z)},
                       {"inject_ml", session.inject_ml(z)},
                       {"present_ml", z < session.present_ml_size() ? session.present_ml(z) : 0.0}});
    }
    ordered_json total = total_of(zones, {"prepare_ml", "inject_ml", "present_ml"});
    record.push_back({{"month", session.month()}, {"zones", std::move(zones)}, {"total", std::move(total)}});
  }
  return record;
}

}  // namespace

ordered_json record_of_volumes(const ReportAnswers& answers, double reserve_share) {
  const double prepare = 1.0 + reserve_share;
  std::vector<v1::ZoneVolumeForecast> zones =
      planned_zones(answers.plan.simulation(), last_month_of(answers.retention));
  if (answers.forecast) zones.assign(answers.forecast->zones().begin(), answers.forecast->zones().end());
  ordered_json record = {{"reserve_share", reserve_share}, {"month", last_month_of(answers.retention).month()}};
  record["zones"] = record_of_zones(answers, zones, prepare);
  record["total"] = total_of(record["zones"], {"prepare_ml", "inject_ml", "remaining_ml"});
  record["sessions"] = answers.forecast ? record_of_sessions(answers, prepare) : ordered_json(nullptr);
  return record;
}

}  // namespace lipofill::client
