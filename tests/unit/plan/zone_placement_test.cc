// Outlines of zones on the cells of a film.

#include "core/plan/zone_placement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/film/film_metric.h"
#include "core/plan/film_layout.h"
#include "tests/unit/simulation/small_case.h"

namespace lipofill::plan {
namespace {

/// A film of n x n cells on a square of 48 mm with 2 n x 2 n quadrilaterals.
struct Case {
  std::shared_ptr<const model::FaceModel> model;
  FilmSpec film = simulation::make_small_plan().films[0];
  explicit Case(int n, std::vector<ZoneSpec> zones) {
    model::FaceModelSpec spec = simulation::make_small_model_spec();
    spec.n_xi = spec.n_eta = 2 * n;
    model = *model::build_face_model(spec, nullptr);
    film.n_xi = film.n_eta = n;
    film.zones = std::move(zones);
  }
  FilmLayout place() const {
    auto layout = place_film(*model, film);
    EXPECT_TRUE(layout.ok()) << layout.status();
    return *std::move(layout);
  }
  /// Area of the cells of a zone [mm2].
  double area(const FilmLayout& layout, int zone) const {
    const Eigen::VectorXd areas =
        film::compute_film_metric(layout.grid, vertices_on_skin(model->geometry.grid, layout.grid)).area;
    double sum = 0.0;
    for (int cell = 0; cell < layout.grid.n_cells(); ++cell) {
      if (layout.grid.zone_of_cell[cell] == zone) sum += areas[cell];
    }
    return sum * 1e6;
  }
};

ZoneSpec disc(const std::string& name, double xi, double eta, double radius) {
  return {name, Disc{geometry::ChartPoint{xi, eta}, radius}};
}

TEST(ZonePlacement, AreaOfADiscIsRightToSecondOrderOnEveryGrid) {
  const double exact = std::numbers::pi * 15.0 * 15.0;
  double last = 0.0;
  for (const int n : {8, 16, 32}) {
    const Case c(n, {disc("a", 0.52, 0.47, 15e-3)});
    const double error = std::abs(c.area(c.place(), 0) - exact) / exact;
    EXPECT_LT(error, 0.2 / (n * n)) << n << " cells";
    if (last > 0.0) {
      EXPECT_GT(std::log2(last / error), 1.5) << n << " cells";
    }
    last = error;
  }
}

TEST(ZonePlacement, AreaFollowsAShiftOfATenthOfACell) {
  const int n = 12;
  const double cell = 1.0 / n;
  for (int k = 0; k < 10; ++k) {
    const Case c(n, {{"a", ChartBox{0.2 + 0.1 * k * cell, 0.8, 0.25, 0.75}}});
    EXPECT_NEAR(c.area(c.place(), 0), 48.0 * 48.0 * (0.6 - 0.1 * k * cell) * 0.5, 1e-9) << k;
  }
}

TEST(ZonePlacement, AsCellsItJumps) {
  Case c(12, {{"a", ChartBox{0.2, 0.8, 0.25, 0.75}}});
  c.film.edge.outline = ZoneOutline::kCells;
  EXPECT_NEAR(c.area(c.place(), 0), 48.0 * 48.0 * 48 / 144.0, 1e-9) << "8 by 6 cells have their centre inside";
}

TEST(ZonePlacement, ZonesThatOverlapShareNothing) {
  const Case both(16, {disc("a", 0.4, 0.5, 12e-3), disc("b", 0.6, 0.5, 12e-3)});
  const FilmLayout layout = both.place();
  const Case alone(16, {disc("a", 0.4, 0.5, 12e-3)});
  // The lens of two discs of radius r at a distance d.
  const double r = 12.0;
  const double d = 0.2 * 48.0;
  const double lens = 2 * r * r * std::acos(d / (2 * r)) - 0.5 * d * std::sqrt(4 * r * r - d * d);
  EXPECT_NEAR(both.area(layout, 0), alone.area(alone.place(), 0), 1e-9) << "the first zone has the place";
  EXPECT_NEAR(both.area(layout, 1), std::numbers::pi * r * r - lens, 0.5);
  for (const film::Edge& edge : layout.grid.edges) {
    EXPECT_EQ(layout.grid.zone_of_cell[edge.left], layout.grid.zone_of_cell[edge.right]);
  }
}

TEST(ZonePlacement, SliversCountToTheCellBeside) {
  // The outline leaves a tenth of a cell's width in the next column.
  const Case c(12, {{"a", ChartBox{0.25, 0.75 + 0.1 / 12, 0.25, 0.75}}});
  const FilmLayout layout = c.place();
  EXPECT_EQ(layout.grid.n_cells(), 36);
  EXPECT_EQ(layout.grid.fragments.size(), 6u);
  EXPECT_NEAR(c.area(layout, 0), 48.0 * 48.0 * (0.5 + 0.1 / 12) * 0.5, 1e-9);
}

TEST(ZonePlacement, ASmallZoneHasACell) {
  const Case c(6, {disc("dot", 0.5, 0.5, 1e-3)});
  const FilmLayout layout = c.place();
  EXPECT_EQ(layout.grid.n_cells(), 1);
  EXPECT_NEAR(c.area(layout, 0), std::numbers::pi, 1.2) << "the chord of each quarter of a cell";
}

TEST(ZonePlacement, PiecesHaveTheAreaOfTheCells) {
  const Case c(12, {disc("a", 0.52, 0.47, 15e-3)});
  const FilmLayout layout = c.place();
  double sum = 0.0;
  for (const film::CellPiece& piece : layout.pieces) {
    const double box = (piece.box.xi_max - piece.box.xi_min) * (piece.box.eta_max - piece.box.eta_min);
    for (const double share : piece.share) sum += 0.25 * share * box * 48.0 * 48.0;
  }
  EXPECT_NEAR(sum, c.area(layout, 0), 1e-9);
}

}  // namespace
}  // namespace lipofill::plan
