// Zones around what is missing: a zone a hollow, inside its line, clear of the rim.

#include "core/planning/zones_from_deficit.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/base/field_violations.h"
#include "tests/unit/planning/square_case.h"

namespace lipofill::planning {
namespace {

/// Hollows on the plate of 48 mm: depth times exp(-(r / width)^2) around each centre of the chart.
geometry::ScalarField make_hollows(const std::vector<std::array<double, 3>>& hollows, double width_mm = 6.0) {
  geometry::ScalarField deficit{25, 25, {}};
  for (int j = 0; j < 25; ++j) {
    for (int i = 0; i < 25; ++i) {
      double depth = 0.0;
      for (const auto& [xi, eta, most] : hollows) {
        const double away = 48.0 * std::hypot(i / 24.0 - xi, j / 24.0 - eta) / width_mm;
        depth += most * std::exp(-away * away);
      }
      deficit.values.push_back(depth * kMillimetre);
    }
  }
  return deficit;
}

double cover_at(const plan::ZoneSpec& zone, double xi, double eta) {
  return std::get<plan::PaintedRegion>(zone.shape).cover.at(xi, eta);
}

TEST(ZonesFromDeficit, AHollowIsAZoneInsideItsLine) {
  const auto model = make_square();
  const auto zones = outline_hollows(*model, make_hollows({{0.5, 0.5, 5.0}}), 0.35, 0.2 * kMillimetre, "z");
  ASSERT_EQ(zones.size(), 1u);
  EXPECT_EQ(zones[0].name, "z1");
  // exp(-(r / 6)^2) = 0.35 at r = 6.15 mm.
  for (const double direction : {0.0, 1.0, 2.5, 4.0}) {
    const auto at = [&](double r) {
      return cover_at(zones[0], 0.5 + r / 48.0 * std::cos(direction), 0.5 + r / 48.0 * std::sin(direction));
    };
    EXPECT_GT(at(5.6), 0.5);
    EXPECT_LT(at(6.7), 0.5);
  }
}

TEST(ZonesFromDeficit, HollowsThatPartAreZonesTheLargestFirst) {
  const auto model = make_square();
  const auto zones =
      outline_hollows(*model, make_hollows({{0.3, 0.3, 2.0}, {0.7, 0.7, 4.0}}), 0.35, 0.3 * kMillimetre, "z");
  ASSERT_EQ(zones.size(), 2u);
  EXPECT_GT(cover_at(zones[0], 0.7, 0.7), 0.5);
  EXPECT_LT(cover_at(zones[0], 0.3, 0.3), 0.5);
  EXPECT_GT(cover_at(zones[1], 0.3, 0.3), 0.5) << "the shallow one is measured by its own depth";
}

TEST(ZonesFromDeficit, ZonesKeepClearOfTheRim) {
  const auto model = make_square();
  const auto zones = outline_hollows(*model, make_hollows({{0.2, 0.5, 5.0}}), 0.2, 0.2 * kMillimetre, "z");
  ASSERT_EQ(zones.size(), 1u);
  EXPECT_LT(cover_at(zones[0], 5.0 / 48.0, 0.5), 0.5);
  EXPECT_GT(cover_at(zones[0], 8.0 / 48.0, 0.5), 0.5);
}

TEST(ZonesFromDeficit, ListsPlanesAndRefusesLayersThatAreNotThere) {
  const auto model = make_square();
  const geometry::ScalarField deficit = make_hollows({{0.5, 0.5, 5.0}}, 9.0);
  ZoneProposals proposals;
  proposals.min_deficit = 0.2 * kMillimetre;
  const auto all = list_zone_layouts(*model, {}, deficit, proposals);
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(all->size(), 7u) << "three levels in each of two planes, and both together";
  EXPECT_EQ(all->back().plan.films.size(), 2u);
  EXPECT_EQ(all->back().n_proposed, 2);
  proposals.below_layers = {"skin", "bone"};
  EXPECT_EQ(field_violations_of(list_zone_layouts(*model, {}, deficit, proposals).status())[0].field,
            "zones.below_layers[1]");
}

}  // namespace
}  // namespace lipofill::planning
