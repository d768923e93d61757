// What a simulation refuses of fat, ligaments, walls and connective tissue, each with the field,
// the value and the bound.

#include "tests/unit/simulation/bad_plan.h"

namespace lipofill::simulation {
namespace {

using geometry::ChartPoint;

plan::LigamentSpec make_ligament() {
  plan::LigamentSpec ligament;
  ligament.name = "septum";
  ligament.place = std::vector<geometry::SkinPoint>{ChartPoint{0.5, 0.5}};
  ligament.stiffness = 100.0;
  return ligament;
}

/// A plan with one ligament, changed.
auto with_ligament(std::function<void(plan::LigamentSpec&)> change) {
  return [change](plan::SimulationSpec& spec) {
    spec.ligaments = {make_ligament()};
    change(spec.ligaments[0]);
  };
}

/// A plan with one wall across its zone, changed.
auto with_wall(std::function<void(plan::WallSpec&)> change) {
  return [change](plan::SimulationSpec& spec) {
    spec.films[0].walls = {{"septum", {ChartPoint{0.5, 0.0}, ChartPoint{0.5, 1.0}}, {}, 0.0}};
    change(spec.films[0].walls[0]);
  };
}

class AnatomyIsRefused : public testing::TestWithParam<BadPlan> {};

TEST_P(AnatomyIsRefused, NamingFieldValueAndBound) {
  expect_refused(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Every, AnatomyIsRefused,
    testing::Values(
        BadPlan{"FlowIndex", [](auto& s) { s.fat_flow_index = 1.5; }, "fat.flow_index", "is 1.5, must be in [0.1, 1]"},
        BadPlan{"Consistency",
                [](auto& s) {
                  s.fat_flow_index = 0.5;
                  s.fat_viscosity = 0.0;
                },
                "fat.consistency_pa_s_n", "is 0 Pa s^n"},
        BadPlan{"YieldStress", [](auto& s) { s.fat_yield_stress = -2; }, "fat.yield_stress_pa", "-2 Pa"},
        BadPlan{"ShearModulus", [](auto& s) { s.fat_shear_modulus = 0; }, "fat.shear_modulus_pa", "is 0 Pa"},
        BadPlan{"YieldWithoutFriction",
                [](auto& s) {
                  s.fat_yield_stress = 5;
                  s.films[0].wall_friction = film::WallFriction::kNone;
                },
                "films[0].wall_friction", "NONE"},
        BadPlan{"SuctionLimit", [](auto& s) { s.suction_limit = -1; }, "suction_limit_pa", "-1 Pa"},
        BadPlan{"ErrorTolerance", [](auto& s) { s.error_tolerance = 0; }, "time.error_tolerance_mm", "is 0 mm"},
        BadPlan{"LigamentName", with_ligament([](auto& l) { l.name = ""; }), "ligaments[0].name", "is empty"},
        BadPlan{"LigamentFilm", with_ligament([](auto& l) { l.film = "other"; }), "ligaments[0].film", "'other'"},
        BadPlan{"LigamentInnerFilm", with_ligament([](auto& l) { l.inner_film = "x"; }), "ligaments[0].inner_film",
                "'x'"},
        BadPlan{"LigamentStiffness", with_ligament([](auto& l) { l.stiffness = 0; }), "ligaments[0].stiffness_n_per_mm",
                "is 0 N/mm"},
        BadPlan{"LigamentSlack", with_ligament([](auto& l) { l.slack = -1e-3; }), "ligaments[0].slack_mm", "-1 mm"},
        BadPlan{"LigamentBreaking", with_ligament([](auto& l) { l.breaking_force = 0; }),
                "ligaments[0].breaking_force_n", "is 0 N"},
        BadPlan{"LigamentNowhere", with_ligament([](auto& l) { l.place = std::vector<geometry::SkinPoint>{}; }),
                "ligaments[0].points.points", "are 0, must be 1 to 256"},
        BadPlan{"LigamentOutsideTheChart", with_ligament([](auto& l) {
                  l.place = std::vector<geometry::SkinPoint>{ChartPoint{1.5, 0.5}};
                }),
                "ligaments[0].points.points[0]", "1.5"},
        BadPlan{"LigamentWhereTissueIsInOnePiece",
                [](auto& s) {
                  s.films[0].zones[0].shape = geometry::ChartBox{0.0, 0.5, 0.0, 1.0};
                  s.injections[0].site = ChartPoint{0.25, 0.45};
                  s.probes.clear();
                  s.ligaments = {make_ligament()};
                  s.ligaments[0].place = std::vector<geometry::SkinPoint>{ChartPoint{0.9, 0.5}};
                },
                "ligaments[0].points.points[0]", "no zone of the film parts the tissue"},
        BadPlan{"LigamentUnknownToAnatomy",
                with_ligament([](auto& l) { l.place = plan::NamedLigament{"cruciate_left"}; }),
                "ligaments[0].anatomical", "cruciate"},
        BadPlan{"WallName", with_wall([](auto& w) { w.path.resize(1, ChartPoint{}); }), "films[0].walls[0].path.points",
                "are 1, must be 2 to 256"},
        BadPlan{"WallLeakage", with_wall([](auto& w) { w.leakage = -1e-7; }),
                "films[0].walls[0].leakage_ml_per_s_kpa_cm", "-1 mL"},
        BadPlan{"WallPartsNothing", with_wall([](auto& w) {
                  w.path = {ChartPoint{0.01, 0.01}, ChartPoint{0.02, 0.02}};
                }),
                "films[0].walls[0]", "parts no two cells"},
        BadPlan{"WallBetweenUnknownZones", with_wall([](auto& w) {
                  w.path.clear();
                  w.between = {"all", "none"};
                }),
                "films[0].walls[0].between.second", "'none'"},
        BadPlan{"WallBetweenAZoneAndItself", with_wall([](auto& w) {
                  w.path.clear();
                  w.between = {"all", "all"};
                }),
                "films[0].walls[0].between.second", "first zone again"},
        BadPlan{"FibreStiffness", [](auto& s) { s.films[0].connective_tissue.stiffness = -1e6; },
                "films[0].connective_tissue.stiffness_kpa_per_mm", "-1 kPa/mm"},
        BadPlan{"EntryPressure", [](auto& s) { s.films[0].connective_tissue.entry_pressure = -5; },
                "films[0].connective_tissue.entry_pressure_pa", "-5 Pa"},
        BadPlan{"FibresBetweenRigidWalls",
                [](auto& s) {
                  s.films[0].wall = plan::FilmWallKind::kRigid;
                  s.films[0].below_layer = "";
                  s.films[0].connective_tissue = {1e6, 10.0};
                },
                "films[0].connective_tissue.stiffness_kpa_per_mm", "only films on tissue"}),
    [](const auto& plan) { return plan.param.name; });

}  // namespace
}  // namespace lipofill::simulation
