// Which plans have a settled shape that the way there does not decide, and what forbids it.

#include "core/equilibrium/scope.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::equilibrium {
namespace {

using geometry::ChartPoint;

/// The field that forbids the small plan, changed; empty: nothing does.
std::string find_field(const std::function<void(plan::SimulationSpec&)>& change, double breaking_force = -1.0,
                       bool is_injected = false) {
  const auto model = simulation::make_small_model();
  plan::SimulationSpec spec = simulation::make_small_plan();
  change(spec);
  std::vector<plan::FilmLayout> films;
  for (const plan::FilmSpec& film : spec.films) {
    const auto placed = plan::place_film(*model, film);
    EXPECT_TRUE(placed.ok()) << placed.status();
    films.push_back(*placed);
  }
  std::vector<mechanics::LigamentLayout> ligaments;
  if (breaking_force > 0.0) ligaments = {{"first", 0, 1, std::numeric_limits<double>::infinity()}};
  if (breaking_force > 0.0) ligaments.push_back({"second", 1, 1, breaking_force});
  const auto found = find_hindrance(spec, *model, films, ligaments, 0.3, is_injected);
  if (found.has_value()) {
    EXPECT_EQ(found->text(), found->field + " " + found->why);
    EXPECT_GT(found->why.size(), 20u) << "says why";
    EXPECT_EQ(found->ends_with_injection,
              found->field.starts_with("ligaments") || found->field.find("entry") != std::string::npos)
        << found->field;
  }
  return found.has_value() ? found->field : "";
}

TEST(Scope, PlainFatIsInIt) {
  EXPECT_EQ(find_field([](auto&) {}), "");
  EXPECT_EQ(find_field([](auto& spec) { spec.fat_flow_index = 0.5; }), "");
  EXPECT_EQ(find_field([](auto& spec) { spec.fat_shear_modulus = 100.0; }), "");
  EXPECT_EQ(find_field([](auto& spec) { spec.gravity = {0.0, 0.0, -9.81}; }), "");
  EXPECT_EQ(find_field([](auto& spec) { spec.suction_limit = 1e3; }), "");
  EXPECT_EQ(find_field([](auto& spec) { spec.films[0].connective_tissue.stiffness = 1e6; }), "");
}

TEST(Scope, YieldStressIsNot) {
  EXPECT_EQ(find_field([](auto& spec) { spec.fat_yield_stress = 1.0; }), "fat.yield_stress_pa");
}

/// Until all is injected; what else forbids it does so then, too.
TEST(Scope, TissueToBeEnteredIsNotUntilAllIsInjected) {
  const auto enter = [](auto& spec) { spec.films[0].connective_tissue.entry_pressure = 100.0; };
  EXPECT_EQ(find_field(enter), "films[0].connective_tissue.entry_pressure_pa");
  EXPECT_EQ(find_field(enter, 0.0, true), "");
  const auto enter_lumped = [](auto& spec) {
    spec.films[0].connective_tissue.entry_pressure = 100.0;
    spec.coupling = plan::CouplingMode::kLumped;
  };
  EXPECT_EQ(find_field(enter_lumped, 0.0, true), "coupling");
}

/// Once all is injected; a yield stress still does.
TEST(Scope, LigamentsForbidItUntilAllIsInjected) {
  EXPECT_EQ(find_field([](auto&) {}, 0.5), "ligaments[1].breaking_force_n");
  EXPECT_EQ(find_field([](auto&) {}, 0.5, true), "");
  EXPECT_EQ(find_field([](auto& spec) { spec.fat_yield_stress = 1.0; }, 0.5, true), "fat.yield_stress_pa");
}

TEST(Scope, LumpedCouplingIsNot) {
  EXPECT_EQ(find_field([](auto& spec) { spec.coupling = plan::CouplingMode::kLumped; }), "coupling");
}

TEST(Scope, FilmsWithWallsOfTheirOwnAreNot) {
  EXPECT_EQ(find_field([](auto& spec) {
              spec.films[0].below_layer.clear();
              spec.films[0].wall = plan::FilmWallKind::kRigid;
            }),
            "films[0].wall");
}

TEST(Scope, LigamentsThatMayBreakAreNot) {
  EXPECT_EQ(find_field([](auto&) {}, 2.0), "ligaments[1].breaking_force_n");
  EXPECT_EQ(find_field([](auto&) {}, std::numeric_limits<double>::infinity()), "") << "slack or not, it holds";
}

TEST(Scope, VoidsAndLeaksUnderGravityAreNot) {
  const Eigen::Vector3d down(0.0, 0.0, -9.81);
  EXPECT_EQ(find_field([&](auto& spec) {
              spec.gravity = down;
              spec.suction_limit = 1e3;
            }),
            "suction_limit_pa");
  const auto leak = [](auto& spec) {
    spec.films[0].walls.push_back({"wall", {ChartPoint{0.5, 0.0}, ChartPoint{0.5, 1.0}}, {}, 1e-9});
  };
  EXPECT_EQ(find_field(leak), "");
  EXPECT_EQ(find_field([&](auto& spec) {
              leak(spec);
              spec.gravity = down;
            }),
            "films[0].walls");
}

TEST(Scope, PlansThatEndBeforeTheyRestAreNot) {
  EXPECT_EQ(find_field([](auto& spec) { spec.settle_skin_speed = 0.0; }), "time.settle_skin_speed_mm_per_s");
  EXPECT_EQ(find_field([](auto& spec) { spec.end = 0.2; }), "time.end_s");
  EXPECT_EQ(find_field([](auto& spec) { spec.end = 0.3; }), "");
}

}  // namespace
}  // namespace lipofill::equilibrium
