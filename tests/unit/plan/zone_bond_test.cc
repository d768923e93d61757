// How the walls of a film hold together around its zones.

#include "core/plan/zone_bond.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/plan/film_layout.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::plan {
namespace {

/// 24 x 24 quadrilaterals of 2 mm, 12 x 12 cells.
struct Case {
  std::shared_ptr<const model::FaceModel> model;
  FilmSpec film = simulation::make_small_plan().films[0];
  explicit Case(std::vector<ZoneSpec> zones) {
    model::FaceModelSpec spec = simulation::make_small_model_spec();
    spec.n_xi = spec.n_eta = 24;
    model = *model::build_face_model(spec, nullptr);
    film.n_xi = film.n_eta = 12;
    film.zones = std::move(zones);
  }
  ZoneBond bond() const {
    auto layout = place_film(*model, film);
    EXPECT_TRUE(layout.ok()) << layout.status();
    return layout->bond;
  }
  int place(int i, int j) const { return model->geometry.grid.surface_index(i, j); }
};

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(ZoneBond, RigidOnASquareAndWithoutSpringsOnTheGrid) {
  const Case c({{"a", ChartBox{0.25, 0.75, 0.25, 0.75}}});
  const ZoneBond bond = c.bond();
  EXPECT_EQ(std::count(bond.open.begin(), bond.open.end(), true), 11 * 11);
  EXPECT_TRUE(bond.open[c.place(7, 7)]);
  EXPECT_FALSE(bond.open[c.place(6, 7)]) << "on the outline";
  EXPECT_EQ(sum(bond.stiffness), 0.0);
}

TEST(ZoneBond, ARigidEdgeBetweenGridLinesIsHeldByWhatLiesOutside) {
  // The outline lies 0.3 of a quadrilateral beyond the line i = 18.
  const Case c({{"a", ChartBox{0.25, 0.75 + 0.3 / 24, 0.25, 0.75}}});
  const ZoneBond bond = c.bond();
  EXPECT_TRUE(bond.open[c.place(18, 12)]);
  EXPECT_FALSE(bond.open[c.place(19, 12)]);
  // int (1 - s) ds from 0.3 to 1 over a row of 2 mm x 2 mm, with E/L of the stiffest layer.
  const double area = 2e-3 * 2e-3;
  EXPECT_NEAR(bond.stiffness[c.place(18, 12)], 2e5 / 2e-3 * area * 0.5 * 0.7 * 0.7, 1e-9);
  EXPECT_NEAR(bond.stiffness[c.place(17, 12)], 0.0, 1e-9);
}

TEST(ZoneBond, AnAttachmentAddsUpToItsIntegral) {
  Case c({{"a", ChartBox{0.25, 0.75, 0.0, 1.0}}});
  c.film.edge.attachment = AttachmentSpec{2e7, 6e-3};
  const ZoneBond bond = c.bond();
  EXPECT_TRUE(bond.open[c.place(4, 12)]) << "4 mm outside";
  EXPECT_FALSE(bond.open[c.place(3, 12)]) << "6 mm outside";
  EXPECT_EQ(bond.stiffness[c.place(12, 12)], 0.0) << "inside";
  // Along a row of 2 mm: k1/w int x dx from 0 to 6 mm less what goes to the place at 6 mm, which is
  // bonded.
  double row = 0.0;
  for (int i = 0; i <= 6; ++i) row += bond.stiffness[c.place(i, 12)];
  const double k_over_w = 2e7 / 6e-3;
  const double at_bonded = k_over_w * (2e-3 * 2e-3 / 2 * 2 + 2e-3 * 2e-3 / 3);
  EXPECT_NEAR(row, 2e-3 * (k_over_w * 6e-3 * 6e-3 / 2 - at_bonded), 1e-6 * row);
}

TEST(ZoneBond, AnAttachmentMovesWithTheOutline) {
  // What a tenth of a quadrilateral (0.2 mm) adds to k1 d/w over a place's share of area.
  const double most = 2e7 * 0.2e-3 / 6e-3 * 2e-3 * 2e-3;
  std::vector<double> last;
  for (int k = 0; k <= 10; ++k) {
    Case c({{"a", ChartBox{0.25, 0.6 + 0.1 * k / 24, 0.25, 0.75}}});
    c.film.edge.attachment = AttachmentSpec{2e7, 6e-3};
    const ZoneBond bond = c.bond();
    for (int i = 13; k > 0 && i <= 16; ++i) {
      const double change = last[c.place(i, 12)] - bond.stiffness[c.place(i, 12)];
      EXPECT_GE(change, -1e-9) << k << ", place " << i;
      EXPECT_LE(change, 1.01 * most) << k << ", place " << i;
    }
    last = bond.stiffness;
  }
}

TEST(ZoneBond, ASeptumStandsWhereTwoZonesTouch) {
  Case c({{"a", ChartBox{0.25, 0.5, 0.25, 0.75}}, {"b", ChartBox{0.5, 0.75, 0.25, 0.75}}});
  EXPECT_FALSE(c.bond().open[c.place(12, 12)]) << "a rigid septum bonds the layers";
  c.film.edge.attachment = AttachmentSpec{2e7, 6e-3};
  const ZoneBond bond = c.bond();
  EXPECT_TRUE(bond.open[c.place(12, 12)]);
  // k1 (1 - 2 d/w) on both sides of the border adds up to k1 w/2 along it.
  double row = 0.0;
  for (int i = 8; i <= 16; ++i) row += bond.stiffness[c.place(i, 12)];
  EXPECT_NEAR(row, 2e7 * 6e-3 / 2 * 2e-3, 0.02 * row);
}

TEST(ZoneBond, AnAttachmentIsChecked) {
  Case c({{"a", ChartBox{0.25, 0.75, 0.25, 0.75}}});
  c.film.edge.attachment = AttachmentSpec{0.0, 6e-3};
  const auto layout = place_film(*c.model, c.film);
  ASSERT_FALSE(layout.ok());
  EXPECT_NE(layout.status().ToString().find("stiffness_kpa_per_mm"), std::string::npos) << layout.status();
}

}  // namespace
}  // namespace lipofill::plan
