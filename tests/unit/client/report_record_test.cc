// The record of a report: what follows from the answers, and what stays out of it.

#include <gmock/gmock.h>

#include "client/cpp/report/command_again.h"
#include "client/cpp/report/record.h"

namespace lipofill::client {
namespace {

using nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::Not;

ReportAnswers make_answers() {
  ReportAnswers answers;
  v1::SimulationSpec& spec = *answers.plan.mutable_simulation();
  for (const auto& [film, layer, zone] :
       {std::tuple("shallow", "skin", "cheek"), std::tuple("deep", "muscle", "chin")}) {
    v1::Film& added = *spec.add_films();
    added.set_name(film);
    added.set_below_layer(layer);
    added.add_zones()->set_name(zone);
  }
  for (const auto& [zone, volume] : {std::pair("chin", 2.0), std::pair("cheek", 1.0), std::pair("chin", 0.5)}) {
    v1::Injection& injection = *spec.add_injections();
    injection.set_zone(zone);
    injection.set_volume_ml(volume);
  }
  v1::RetentionAtMonth& month = *answers.retention.add_months();
  month.set_month(12);
  month.set_p05(0.2);
  month.set_p50(0.5);
  month.set_p95(0.75);
  answers.model.set_name("patients/x7q/models/m9k");
  answers.model.mutable_spec()->mutable_scan_region()->set_scan("patients/x7q/scans/s3f");
  answers.planned.simulation.set_name("simulations/zz1");
  answers.planned.simulation.mutable_summary()->set_wall_s(3.21);
  return answers;
}

ordered_json record_of(const ReportAnswers& answers) {
  return report_record(answers, {"2026-11-30", "case-7", "0.1.0", "lipofill report", "abc", 0.1});
}

TEST(ReportRecord, SumsVolumesByZoneWithTheirPlanes) {
  const ordered_json volumes = record_of(make_answers()).at("volumes");
  ASSERT_EQ(volumes.at("zones").size(), 2u);
  const ordered_json& chin = volumes.at("zones").at(0);
  EXPECT_EQ(chin.at("zone"), "chin");
  EXPECT_EQ(chin.at("below_layer"), "muscle");
  EXPECT_DOUBLE_EQ(chin.at("inject_ml"), 2.5);
  EXPECT_DOUBLE_EQ(chin.at("prepare_ml"), 2.75);
  EXPECT_DOUBLE_EQ(chin.at("remaining_ml"), 1.25);
  EXPECT_DOUBLE_EQ(chin.at("remaining_p05_ml"), 0.5);
  EXPECT_DOUBLE_EQ(chin.at("remaining_p95_ml"), 1.875);
  EXPECT_EQ(volumes.at("zones").at(1).at("below_layer"), "skin");
  EXPECT_DOUBLE_EQ(volumes.at("total").at("inject_ml"), 3.5);
  EXPECT_TRUE(volumes.at("sessions").is_null()) << "without a forecast there are none";
}

TEST(ReportRecord, TakesZonesAndSessionsOfAForecast) {
  ReportAnswers answers = make_answers();
  v1::Forecast& forecast = answers.forecast.emplace();
  v1::ZoneVolumeForecast& zone = *forecast.add_zones();
  zone.set_zone("chin");
  zone.set_planned_ml(2.5);
  zone.set_remaining_ml(1.1);
  for (const double volume : {1.5, 0.5}) {
    v1::PlannedSession& session = *forecast.add_sessions();
    session.add_inject_ml(volume);
    session.add_present_ml(0.25);
  }
  const ordered_json volumes = record_of(answers).at("volumes");
  EXPECT_DOUBLE_EQ(volumes.at("zones").at(0).at("remaining_ml"), 1.1);
  ASSERT_EQ(volumes.at("sessions").size(), 2u);
  const ordered_json& second = volumes.at("sessions").at(1);
  EXPECT_DOUBLE_EQ(second.at("zones").at(0).at("inject_ml"), 0.5);
  EXPECT_DOUBLE_EQ(second.at("total").at("prepare_ml"), 0.55);
}

TEST(ReportRecord, GathersPassesByTunnel) {
  ReportAnswers answers = make_answers();
  v1::Delivery& delivery = answers.delivery.emplace();
  for (const auto& [tunnel, volume] : {std::pair(0u, 0.1), std::pair(0u, 0.05), std::pair(1u, 0.1)}) {
    v1::CannulaPass& pass = *delivery.add_passes();
    pass.set_tunnel(tunnel);
    pass.set_volume_ml(volume);
    pass.add_path_mm();
  }
  const ordered_json record = record_of(answers).at("delivery");
  ASSERT_EQ(record.at("tunnels").size(), 2u);
  EXPECT_EQ(record.at("tunnels").at(0).at("passes"), 2);
  EXPECT_DOUBLE_EQ(record.at("tunnels").at(0).at("volume_ml"), 0.15);
  EXPECT_DOUBLE_EQ(record.at("tunnels").at(0).at("most_in_a_pass_ml"), 0.1);
}

TEST(ReportRecord, HasNoNamesOfResourcesAndNoTimesOfComputing) {
  const std::string text = record_of(make_answers()).dump();
  EXPECT_THAT(text, Not(HasSubstr("x7q")));
  EXPECT_THAT(text, Not(HasSubstr("zz1")));
  EXPECT_THAT(text, Not(HasSubstr("3.21")));
  EXPECT_THAT(text, HasSubstr("not a medical device"));
}

TEST(CommandAgain, NamesFilesAloneAndSaysTheDate) {
  EXPECT_EQ(command_again({"report", "/home/me/jaw_angle.json", "--out", "/tmp/x", "--spawn", "--target=/tmp/goal.obj",
                           "--members", "100", "--json"},
                          "2026-11-30"),
            "lipofill report jaw_angle.json --target=goal.obj --members 100 --date 2026-11-30 --out report --spawn");
  EXPECT_EQ(command_again({"report", "a b.json", "--server", "host:1", "--patient", "case-7", "--out=r"}, "2026-11-30"),
            "lipofill report 'a b.json' --patient case-7 --date 2026-11-30 --out report");
}

}  // namespace
}  // namespace lipofill::client
