// The springs that join the walls of films: where they sit, between which nodes, and how stiff they
// are.

#include "core/mechanics/wall_fibres.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "core/base/field_violations.h"
#include "core/mechanics/tissue_setup.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::mechanics {
namespace {

using geometry::ChartPoint;
using ::testing::HasSubstr;

/// The small model with a film under the skin and one under the muscle, over the first two thirds
/// of the chart.
struct Case {
  std::shared_ptr<const model::FaceModel> model = [] {
    model::FaceModelSpec spec = simulation::make_small_model_spec();
    spec.layers.push_back(spec.layers[1]);
    spec.layers[2].name = "deep";
    return *model::build_face_model(spec, nullptr);
  }();
  std::vector<plan::FilmLayout> films;
  HeldMesh held;

  explicit Case(double fibre_stiffness = 0.0) {
    plan::FilmSpec spec = simulation::make_small_plan().films[0];
    spec.zones = {{"zone", plan::ChartBox{0.0, 2.0 / 3.0, 0.0, 1.0}}};
    spec.connective_tissue.stiffness = fibre_stiffness;
    films.push_back(*plan::place_film(*model, spec));
    spec.name = "lower";
    spec.below_layer = "muscle";
    spec.connective_tissue.stiffness = 0.0;
    films.push_back(*plan::place_film(*model, spec));
    held = hold_mesh(*model, films);
  }

  absl::StatusOr<WallFibres> place(const std::vector<plan::LigamentSpec>& ligaments, size_t n_films = 2) const {
    std::vector<FilmOnTissue> on_tissue;
    for (size_t f = 0; f < n_films; ++f) on_tissue.push_back({&films[f], &held.walls[f]});
    return place_wall_fibres(*model, on_tissue, ligaments, held.split.mesh);
  }
  std::string refusal(const std::vector<plan::LigamentSpec>& ligaments, size_t n_films = 2) const {
    const std::vector<FieldViolation> all = field_violations_of(place(ligaments, n_films).status());
    EXPECT_EQ(all.size(), 1u);
    return all.empty() ? "" : all[0].field + ": " + all[0].description;
  }
  /// Where the weights of a spring put its end [m].
  Eigen::Vector3d end_of(const solid::WallSpring& spring, const std::array<int, 4>& nodes) const {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    for (int k = 0; k < 4; ++k) at += spring.weight[k] * held.split.mesh.rest_positions.col(nodes[k]);
    return at;
  }
};

plan::LigamentSpec ligament(std::vector<geometry::SkinPoint> points) {
  plan::LigamentSpec spec;
  spec.name = "ligament";
  spec.place = std::move(points);
  spec.stiffness = 700.0;
  return spec;
}

/// Chart point (0.3, 0.4) of 48 mm is at (14.4, 19.2) mm; the film lies under 2 mm of skin.
TEST(WallFibres, ALigamentHoldsTheWallsAtItsPoints) {
  const Case c;
  plan::LigamentSpec spec = ligament({ChartPoint{0.3, 0.4}, ChartPoint{0.25, 0.5}});
  spec.slack = 1.5e-3;
  spec.breaking_force = 12.0;
  const auto fibres = c.place({spec});
  ASSERT_TRUE(fibres.ok()) << fibres.status();
  ASSERT_EQ(fibres->springs.size(), 2u);
  const solid::WallSpring& spring = fibres->springs[0];
  EXPECT_LT((c.end_of(spring, spring.outer) - Eigen::Vector3d(14.4e-3, 19.2e-3, -2e-3)).norm(), 1e-15);
  EXPECT_LT((c.end_of(spring, spring.inner) - Eigen::Vector3d(14.4e-3, 19.2e-3, -2e-3)).norm(), 1e-15);
  for (int k = 0; k < 4; ++k) EXPECT_NE(spring.outer[k], spring.inner[k]) << "the two walls' own nodes";
  EXPECT_EQ(spring.stiffness, 700.0);
  EXPECT_EQ(spring.slack, 1.5e-3);
  ASSERT_EQ(fibres->ligaments.size(), 1u);
  EXPECT_EQ(fibres->ligaments[0].name, "ligament");
  EXPECT_EQ(fibres->ligaments[0].first_spring, 0);
  EXPECT_EQ(fibres->ligaments[0].n_springs, 2);
  EXPECT_EQ(fibres->ligaments[0].breaking_force, 12.0);
}

TEST(WallFibres, ALigamentAcrossTwoFilmsJoinsTheOutermostWithTheInnermost) {
  const Case c;
  plan::LigamentSpec spec = ligament({ChartPoint{0.3, 0.4}});
  spec.film = "film";
  spec.inner_film = "lower";
  plan::LigamentSpec second = ligament({ChartPoint{0.4, 0.4}});
  second.name = "second";
  second.film = "lower";
  const auto fibres = c.place({spec, second});
  ASSERT_TRUE(fibres.ok()) << fibres.status();
  const solid::WallSpring& across = fibres->springs[0];
  EXPECT_NEAR(c.end_of(across, across.outer)[2], -2e-3, 1e-15);
  EXPECT_NEAR(c.end_of(across, across.inner)[2], -10e-3, 1e-15);
  const solid::WallSpring& lower = fibres->springs[1];
  EXPECT_NEAR(c.end_of(lower, lower.outer)[2], -10e-3, 1e-15);
  EXPECT_EQ(fibres->ligaments[1].first_spring, 1);
  EXPECT_EQ(fibres->ligaments[1].breaking_force, std::numeric_limits<double>::infinity()) << "it holds";
}

/// One spring a doubled node, k times the node's share of the area. The tissue is parted at the
/// nodes of columns 0 to 7: seven and a half quadrilaterals of 4 mm, by 48 mm.
TEST(WallFibres, ConnectiveTissueIsSpreadByArea) {
  constexpr double kStiffness = 3e6;  // [Pa/m]
  const Case c(kStiffness);
  const auto fibres = c.place({});
  ASSERT_TRUE(fibres.ok()) << fibres.status();
  ASSERT_EQ(fibres->springs.size(), 8u * 13u);
  double total = 0.0;
  for (const solid::WallSpring& spring : fibres->springs) {
    total += spring.stiffness;
    EXPECT_NE(spring.outer[0], spring.inner[0]);
    EXPECT_EQ(spring.weight, (std::array<double, 4>{1.0, 0.0, 0.0, 0.0}));
    EXPECT_EQ(spring.slack, 0.0);
    EXPECT_LT((c.end_of(spring, spring.outer) - c.end_of(spring, spring.inner)).norm(), 1e-18);
  }
  EXPECT_NEAR(total, kStiffness * 7.5 * 4e-3 * 48e-3, 1e-9 * total);
  EXPECT_NEAR(fibres->springs[0].stiffness, kStiffness * 0.25 * 16e-6, 1e-9) << "the node at the corner";
  EXPECT_NEAR(fibres->springs[8 + 1].stiffness, kStiffness * 16e-6, 1e-9) << "a node inside";
  EXPECT_TRUE(fibres->ligaments.empty());
}

TEST(WallFibres, LigamentsComeBeforeTheFibres) {
  const Case c(1e6);
  const auto fibres = c.place({ligament({ChartPoint{0.3, 0.4}})});
  ASSERT_TRUE(fibres.ok()) << fibres.status();
  EXPECT_EQ(fibres->springs.size(), 1u + 8u * 13u);
  EXPECT_EQ(fibres->springs[0].stiffness, 700.0);
}

TEST(WallFibres, RefusesWhatJoinsNothing) {
  const Case c;
  const plan::LigamentSpec good = ligament({ChartPoint{0.3, 0.4}});
  const auto with = [&](auto change) {
    plan::LigamentSpec spec = good;
    change(spec);
    return std::vector<plan::LigamentSpec>{spec};
  };
  EXPECT_THAT(c.refusal({good}, 0), HasSubstr("ligaments[0]: needs a film on tissue"));
  EXPECT_THAT(c.refusal(with([](auto& s) {
    s.film = "none";
    s.inner_film = "film";
  })),
              HasSubstr("ligaments[0].film: is 'none'"));
  EXPECT_THAT(c.refusal(with([](auto& s) {
    s.film = "lower";
    s.inner_film = "film";
  })),
              HasSubstr("ligaments[0].inner_film: is 'film', which lies outside 'lower'"));
  EXPECT_THAT(c.refusal({good, good}), HasSubstr("ligaments[1].name: is 'ligament' a second time"));
  EXPECT_THAT(c.refusal(with([](auto& s) { s.name.clear(); })), HasSubstr("ligaments[0].name: is empty"));
  EXPECT_THAT(c.refusal(with([](auto& s) { s.stiffness = 0.0; })), HasSubstr("ligaments[0].stiffness_n_per_mm: "));
  EXPECT_THAT(c.refusal(with([](auto& s) { s.slack = -1e-3; })), HasSubstr("ligaments[0].slack_mm: "));
  EXPECT_THAT(c.refusal(with([](auto& s) { s.breaking_force = 0.0; })), HasSubstr("ligaments[0].breaking_force_n: "));
  EXPECT_THAT(c.refusal({ligament({})}), HasSubstr("ligaments[0].points.points: are 0, must be 1 to 256"));
  EXPECT_THAT(c.refusal({ligament({ChartPoint{0.9, 0.4}})}), HasSubstr("no zone of the film parts the tissue"));
  EXPECT_THAT(c.refusal(std::vector<plan::LigamentSpec>(65, good)), HasSubstr("ligaments: are 65, must be at most 64"));
}

}  // namespace
}  // namespace lipofill::mechanics
