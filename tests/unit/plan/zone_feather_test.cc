// Where fat goes that feathers out beyond the outline of its zone.

#include "core/plan/zone_feather.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/plan/film_layout.h"
#include "core/plan/zone_attachment.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::plan {
namespace {

constexpr double kWidth = 6e-3;

/// A flat square of 48 mm with 24 x 24 quadrilaterals of 2 mm.
struct Case {
  std::shared_ptr<const model::FaceModel> model;
  FilmSpec film = simulation::make_small_plan().films[0];
  explicit Case(std::vector<ZoneSpec> zones, bool feathers = true) {
    model::FaceModelSpec spec = simulation::make_small_model_spec();
    spec.n_xi = spec.n_eta = 24;
    model = *model::build_face_model(spec, nullptr);
    film.n_xi = film.n_eta = 12;
    film.zones = std::move(zones);
    film.edge.attachment = AttachmentSpec{2e7, kWidth, feathers};
  }
  FilmLayout layout() const {
    auto layout = place_film(*model, film);
    EXPECT_TRUE(layout.ok()) << layout.status();
    return std::move(*layout);
  }
};

/// Area of the pieces of a film's cells of a zone, in shares of the chart.
double area_of(const FilmLayout& layout, int zone) {
  double area = 0.0;
  for (const film::CellPiece& piece : layout.pieces) {
    if (layout.grid.zone_of_cell[piece.cell] != zone) continue;
    const double box = (piece.box.xi_max - piece.box.xi_min) * (piece.box.eta_max - piece.box.eta_min);
    for (const double share : piece.share) area += 0.25 * share * box;
  }
  return area;
}

TEST(ZoneFeather, FatReachesTheWidthBeyondTheOutline) {
  const double radius = 10e-3, side = 48e-3;
  const std::vector<ZoneSpec> zones = {{"a", Disc{geometry::ChartPoint{0.5, 0.5}, radius}}};
  const double expected = M_PI * (radius + kWidth) * (radius + kWidth) / (side * side);
  EXPECT_NEAR(area_of(Case(zones).layout(), 0), expected, 0.005 * expected);
  const double sealed = M_PI * radius * radius / (side * side);
  EXPECT_NEAR(area_of(Case(zones, false).layout(), 0), sealed, 0.005 * sealed);
}

TEST(ZoneFeather, TheBondIsThatOfTheOutlineAsDrawn) {
  const std::vector<ZoneSpec> zones = {{"a", ChartBox{0.25, 0.75, 0.25, 0.75}}};
  const ZoneBond feathered = Case(zones).layout().bond;
  const ZoneBond sealed = Case(zones, false).layout().bond;
  for (size_t place = 0; place < sealed.open.size(); ++place) {
    if (!sealed.open[place]) continue;
    EXPECT_TRUE(feathered.open[place]) << place;
    EXPECT_DOUBLE_EQ(feathered.stiffness[place], sealed.stiffness[place]) << place;
  }
}

TEST(ZoneFeather, BetweenTwoZonesFatStaysWithTheNearer) {
  // 0.1 of the chart, 4.8 mm, lies between them: less than two widths.
  const Case c({{"a", ChartBox{0.2, 0.45, 0.2, 0.8}}, {"b", ChartBox{0.55, 0.8, 0.2, 0.8}}});
  const FilmLayout layout = c.layout();
  EXPECT_NEAR(area_of(layout, 0), area_of(layout, 1), 1e-9) << "none is favoured";
  for (const film::CellPiece& piece : layout.pieces) {
    const double middle = 0.5 * (piece.box.xi_min + piece.box.xi_max);
    if (std::abs(middle - 0.5) < 1e-9) continue;
    EXPECT_EQ(layout.grid.zone_of_cell[piece.cell], middle < 0.5 ? 0 : 1) << middle;
  }
}

TEST(ZoneFeather, OnlyTheZoneItselfIsInjected) {
  const Case c({{"a", ChartBox{0.25, 0.75, 0.25, 0.75}}});
  const FilmLayout layout = c.layout();
  int n_in = 0;
  for (int cell = 0; cell < layout.grid.n_cells(); ++cell) {
    const geometry::ChartPoint centre = layout.cell_centre(cell);
    const bool is_in = centre.xi > 0.25 && centre.xi < 0.75 && centre.eta > 0.25 && centre.eta < 0.75;
    EXPECT_EQ(layout.lies_in_zone(cell, 0), is_in) << centre.xi << ", " << centre.eta;
    n_in += is_in;
  }
  EXPECT_EQ(n_in, 36);
  EXPECT_GT(layout.grid.n_cells(), n_in);
}

TEST(ZoneFeather, WhatTheExtentCutsOffIsSaid) {
  const Case c({{"a", ChartBox{0.05, 0.5, 0.3, 0.7}}});
  const std::vector<std::string> remarks = c.layout().remarks;
  EXPECT_TRUE(std::any_of(remarks.begin(), remarks.end(), [](const std::string& remark) {
    return remark.find("Fat of zone a would feather 6 mm beyond its outline") != std::string::npos;
  })) << remarks.size();
  const Case whole({{"a", ChartBox{0.3, 0.7, 0.3, 0.7}}});
  EXPECT_TRUE(whole.layout().remarks.empty());
}

TEST(ZoneFeather, ARigidEdgeHasNone) {
  Case c({{"a", ChartBox{0.25, 0.75, 0.25, 0.75}}});
  EXPECT_EQ(find_feather_widths(*c.model, c.film), std::vector<double>{kWidth});
  c.film.edge = {};
  c.film.edge.is_rigid = true;
  EXPECT_EQ(find_feather_widths(*c.model, c.film), std::vector<double>{0.0});
}

}  // namespace
}  // namespace lipofill::plan
