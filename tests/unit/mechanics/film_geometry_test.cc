// The mid-surfaces of the films: where they are at rest, and how they follow the tissue.

#include "core/mechanics/film_geometry.h"

#include "tests/unit/mechanics/small_system.h"

namespace lipofill::mechanics {
namespace {

/// A cell of the small plan: 48 mm in 6 parts.
constexpr double kCellArea = 8e-3 * 8e-3;

TEST(FilmGeometry, RestAreaIsThatOfTheCells) {
  SmallSystem c;
  const FilmGeometry geometry(c.model->geometry.grid, c.films, c.cells, c.system.get());
  ASSERT_EQ(geometry.rest_area(0).size(), 36);
  EXPECT_LT((geometry.rest_area(0).array() - kCellArea).abs().maxCoeff(), 1e-14 * kCellArea);
  EXPECT_EQ(geometry.metric(0).area, geometry.rest_area(0));
}

/// A linear map of the tissue maps the mid-surface alike: its area grows by the map's determinant
/// in the plane.
TEST(FilmGeometry, AFilmOnTissueFollowsIt) {
  SmallSystem c;
  FilmGeometry geometry(c.model->geometry.grid, c.films, c.cells, c.system.get());
  const Eigen::Matrix3Xd stretched = Eigen::Vector3d(1.1, 0.8, 1.0).asDiagonal() * c.system->rest_positions();
  const film::FilmMetric elsewhere = geometry.metric_at(0, stretched);
  EXPECT_LT((elsewhere.area.array() - 0.88 * kCellArea).abs().maxCoeff(), 1e-13 * kCellArea);
  EXPECT_EQ(geometry.metric(0).area, geometry.rest_area(0)) << "metric_at moves nothing";
  const film::FilmMetric& now = geometry.update(0, stretched);
  EXPECT_LT((now.area - elsewhere.area).cwiseAbs().maxCoeff(), 1e-15 * kCellArea);
  EXPECT_EQ(geometry.metric(0).area, now.area);
  EXPECT_LT((geometry.rest_area(0).array() - kCellArea).abs().maxCoeff(), 1e-14 * kCellArea);
}

/// Only the outer wall moves, so that the middle between both moves by half.
TEST(FilmGeometry, TheMiddleLiesHalfWayBetweenTheWalls) {
  SmallSystem c;
  FilmGeometry geometry(c.model->geometry.grid, c.films, c.cells, c.system.get());
  const Eigen::Matrix3Xd rest = geometry.metric(0).vertices;
  Eigen::Matrix3Xd x = c.system->rest_positions();
  const coupling::WallNodes& walls = c.system->setup().walls[0];
  for (size_t k = 0; k < walls.outer.size(); ++k) {
    ASSERT_NE(walls.outer[k], walls.inner[k]) << "the film of the small plan is open everywhere";
    x(2, walls.outer[k]) += 2e-3;
  }
  const Eigen::Matrix3Xd moved = geometry.update(0, x).vertices - rest;
  EXPECT_LT((moved.row(2).array() - 1e-3).abs().maxCoeff(), 1e-15);
  EXPECT_LT(moved.topRows<2>().cwiseAbs().maxCoeff(), 1e-15);
}

/// A film with walls of its own lies on the undeformed skin, which the small model has at z = 0,
/// whatever the tissue does.
TEST(FilmGeometry, AFilmWithWallsOfItsOwnStays) {
  SmallSystem c;
  plan::FilmLayout winkler = c.films[0];
  winkler.wall = plan::FilmWallKind::kWinkler;
  const std::vector<plan::FilmLayout> films{winkler, c.films[0]};
  const FilmCells cells = number_cells(films);
  FilmGeometry geometry(c.model->geometry.grid, films, cells, c.system.get());
  EXPECT_EQ(geometry.metric(0).vertices.row(2).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_NEAR(geometry.metric(1).vertices(2, 0), -2e-3, 1e-15) << "below 2 mm of skin";
  const Eigen::Matrix3Xd x = 1.5 * c.system->rest_positions();
  EXPECT_EQ(geometry.update(0, x).area, geometry.rest_area(0));
  EXPECT_EQ(geometry.metric_at(0, x).area, geometry.rest_area(0));
  EXPECT_NEAR(geometry.update(1, x).area[0], 2.25 * kCellArea, 1e-13 * kCellArea);
}

}  // namespace
}  // namespace lipofill::mechanics
