#include "client/cpp/result_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace lipofill::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

v1::Simulation sample() {
  v1::Simulation simulation;
  simulation.set_state(v1::Simulation::SETTLED);
  simulation.set_reason("at rest");
  v1::Summary* summary = simulation.mutable_summary();
  summary->set_steps(120);
  summary->set_injected_ml(4.5);
  summary->set_max_pressure_pa(1333.22);
  summary->set_min_pressure_pa(-std::numeric_limits<double>::infinity());
  summary->set_state_hash("abc");
  summary->add_zones()->set_name("masseter");
  summary->set_rejected_steps(3);
  summary->set_undelivered_ml(-0.25);
  v1::LigamentSummary* ligament = summary->add_ligaments();
  ligament->set_name("zygomatic");
  ligament->set_tension_n(1.5);
  ligament->set_points(2);
  ligament->set_broken_points(1);
  summary->mutable_cost()->set_cpu_ms(250);
  summary->mutable_cost()->set_factor_cpu_ms(130);
  summary->mutable_cost()->set_factorisations(4);
  summary->mutable_cost()->set_fallbacks(2);
  return simulation;
}

TEST(SummaryJson, HasTheKeysOthersRelyOn) {
  const auto json = nlohmann::ordered_json::parse(summary_json("jaw_angle", sample()));
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_THAT(
      keys, UnorderedElementsAre(
                "plan", "state", "reason", "steps", "time_s", "wall_s", "step_ms_median", "hexahedra", "film_cells",
                "dofs", "injected_ml", "film_volume_ml", "gap_volume_ml", "film_volume_relative_error",
                "gap_volume_relative_error", "max_pressure_pa", "min_pressure_pa", "mean_pressure_pa",
                "max_thickness_mm", "skin_max_displacement_mm", "skin_volume_change_ml", "min_scaled_jacobian",
                "state_hash", "zones", "layers", "remarks", "rejected_steps", "error_estimate_mm", "settling_error_mm",
                "void_volume_ml", "undelivered_ml", "elastic_energy_mj", "kinetic_energy_mj", "injection_work_mj",
                "film_dissipation_mj", "closed_cells", "ligaments", "preview", "cost", "way", "discretisation_error"));
  keys.clear();
  for (const auto& [key, value] : json["zones"][0].items()) keys.push_back(key);
  EXPECT_THAT(keys, ElementsAre("name", "volume_ml", "mean_pressure_pa", "max_thickness_mm"));
  EXPECT_EQ(json["plan"], "jaw_angle");
  EXPECT_EQ(json["state"], "SETTLED");
  EXPECT_EQ(json["steps"], 120);
  EXPECT_EQ(json["injected_ml"], 4.5);
  EXPECT_TRUE(json["min_pressure_pa"].is_null());
  EXPECT_TRUE(json["settling_error_mm"].is_null());
  EXPECT_EQ(json["ligaments"][0]["broken_points"], 1);
  EXPECT_EQ(json["cost"]["cpu_ms"], 250.0);
  EXPECT_EQ(json["cost"]["fallbacks"], 2);
  EXPECT_TRUE(json["preview"].is_null());
}

TEST(Preview, IsToldWithItsDifferenceOnceThatIsKnown) {
  v1::Simulation simulation = sample();
  v1::PreviewSummary* preview = simulation.mutable_summary()->mutable_preview();
  preview->set_state(v1::PreviewSummary::DONE);
  preview->set_steps(24);
  preview->set_wall_s(0.25);
  preview->set_hexahedra(620);
  preview->set_skin_max_displacement_mm(4.25);
  auto json = nlohmann::ordered_json::parse(summary_json("jaw_angle", simulation));
  EXPECT_EQ(json["preview"]["state"], "DONE");
  EXPECT_EQ(json["preview"]["steps"], 24);
  EXPECT_TRUE(json["preview"]["difference_max_mm"].is_null());
  EXPECT_THAT(summary_text("jaw_angle", simulation), HasSubstr("  preview      skin moved 4.25 mm at most"));
  EXPECT_THAT(summary_text("jaw_angle", simulation), ::testing::Not(HasSubstr("from the result")));
  preview->set_difference_max_mm(0.5);
  preview->set_difference_rms_mm(0.125);
  preview->set_difference_volume_ml(-0.25);
  json = nlohmann::ordered_json::parse(summary_json("jaw_angle", simulation));
  EXPECT_EQ(json["preview"]["difference_rms_mm"], 0.125);
  EXPECT_THAT(summary_text("jaw_angle", simulation),
              HasSubstr("0.50 mm from the result at most, 0.12 mm rms; -0.25 mL of volume"));
  preview->set_state(v1::PreviewSummary::FAILED);
  preview->set_reason("too narrow");
  EXPECT_EQ(preview_text(*preview), "FAILED, too narrow");
}

TEST(SummaryText, IsForPeople) {
  const std::string text = summary_text("jaw_angle", sample());
  EXPECT_THAT(text, HasSubstr("jaw_angle: SETTLED (at rest)"));
  EXPECT_THAT(text, HasSubstr("4.500 mL injected"));
  EXPECT_THAT(text, HasSubstr("10.0 mmHg"));
  EXPECT_THAT(text, HasSubstr("processor    250 ms: tissue 0, factors 130"));
  EXPECT_THAT(text, HasSubstr("4 factors, 0 solves, 2 fallbacks"));
  EXPECT_THAT(text, HasSubstr("3 taken back"));
  EXPECT_THAT(text, HasSubstr("0.250 mL less than planned"));
  EXPECT_THAT(text, HasSubstr("1.50 N, walls 0.00 mm apart, 1 of 2 points broken"));
  EXPECT_THAT(text, HasSubstr("Research and planning aid, not a medical device."));
}

TEST(SeriesCsv, NamesUnitsAndKeepsValues) {
  v1::SimulationSpec spec;
  spec.add_probes()->set_name("centre");
  spec.add_probes()->set_name("edge");
  v1::SeriesRow row;
  row.set_step(7);
  row.set_time_s(0.1);
  row.set_injected_ml(1.0 / 3.0);
  row.add_probe_thickness_mm(0.25);
  row.add_probe_pressure_pa(12);
  row.set_wall_ms(9);
  row.mutable_cost()->set_cpu_ms(8.5);
  row.mutable_cost()->set_newton_iterations(3);
  EXPECT_EQ(
      series_csv(spec, {row}),
      "step,time_s,step_ms,injected_ml,film_volume_ml,gap_volume_ml,max_pressure_pa,min_pressure_pa,max_thickness_mm,"
      "skin_max_displacement_mm,skin_speed_mm_per_s,probe_centre_thickness_mm,probe_centre_pressure_pa,"
      "probe_edge_thickness_mm,probe_edge_pressure_pa,wall_ms,rejected_steps,error_estimate_mm,void_volume_ml,"
      "elastic_energy_mj,injection_work_mj,film_dissipation_mj,ligament_tension_n,broken_ligament_points,closed_cells,"
      "cpu_ms,element_cpu_ms,factor_cpu_ms,solve_cpu_ms,film_cpu_ms,coupling_cpu_ms,factorisations,tissue_solves,"
      "film_iterations,newton_iterations,iterative_iterations,fallbacks\n"
      "7,0.1,0,0.3333333333333333,0,0,0,0,0,0,0,0.25,12,,,9,0,0,0,0,0,0,0,0,0,8.5,0,0,0,0,0,0,0,0,3,0,0\n");
}

}  // namespace
}  // namespace lipofill::client
