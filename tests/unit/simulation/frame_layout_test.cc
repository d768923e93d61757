#include "core/simulation/frame_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "core/model/face_model.h"

namespace lipofill::simulation {
namespace {

using ::testing::ElementsAre;

/// A flat skin of n x n cells, 1 m wide.
geometry::FaceGeometry make_flat(int n) {
  geometry::FaceGeometry face;
  face.grid.n_xi = face.grid.n_eta = n;
  face.grid.nodes.resize(3, (n + 1) * (n + 1));
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      face.grid.nodes.col(face.grid.surface_index(i, j)) << static_cast<double>(i) / n, static_cast<double>(j) / n, 0.0;
    }
  }
  return face;
}

/// A film of 2 x 2 slots over a box of the chart; the slot at the lower right is no cell.
plan::FilmLayout make_film(int level, const geometry::ChartBox& extent) {
  plan::FilmLayout film;
  film.level = level;
  film.grid = film::make_film_grid(extent, 2, 2, {0, -1, 0, 0});
  return film;
}

/// Place of a point of the layout on a flat skin.
Eigen::Vector3d place_of(const SkinPoint& point, const geometry::FaceGeometry& face) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) place += point.weights[k] * face.grid.nodes.col(point.nodes[k]);
  return place;
}

TEST(FrameLayout, ItsOwnSkinMovesWithItsNodes) {
  const geometry::FaceGeometry face = make_flat(4);
  const FrameLayout layout = make_frame_layout(face.grid, {}, face);
  ASSERT_EQ(layout.skin.size(), 25u);
  for (int vertex = 0; vertex < 25; ++vertex) {
    const SkinPoint& point = layout.skin[static_cast<size_t>(vertex)];
    EXPECT_EQ(point.vertex, vertex);
    EXPECT_TRUE(place_of(point, face).isApprox(face.grid.nodes.col(vertex), 1e-15)) << vertex;
    EXPECT_EQ(point.film, -1);
  }
}

TEST(FrameLayout, AnotherSkinAndTheScanLieBetweenNodes) {
  const geometry::FaceGeometry coarse = make_flat(4);
  geometry::FaceGeometry fine = make_flat(6);
  fine.scan.points.resize(3, 9);
  fine.riders = {{3, {0.3, 0.7}}, {8, {1.0, 1.0}}};
  const FrameLayout layout = make_frame_layout(coarse.grid, {}, fine);
  ASSERT_EQ(layout.skin.size(), 49u);
  for (const SkinPoint& point : layout.skin) {
    EXPECT_TRUE(place_of(point, coarse).isApprox(fine.grid.nodes.col(point.vertex), 1e-12)) << point.vertex;
    EXPECT_NEAR(std::accumulate(point.weights.begin(), point.weights.end(), 0.0), 1.0, 1e-15);
  }
  ASSERT_EQ(layout.scan.size(), 2u) << "vertices that do not ride are left where they are";
  EXPECT_EQ(layout.scan[0].vertex, 3);
  EXPECT_TRUE(place_of(layout.scan[0], coarse).isApprox(Eigen::Vector3d(0.3, 0.7, 0.0), 1e-12));
  EXPECT_EQ(layout.scan[1].vertex, 8);
  EXPECT_TRUE(place_of(layout.scan[1], coarse).isApprox(Eigen::Vector3d(1.0, 1.0, 0.0), 1e-12));
}

TEST(FrameLayout, APointSeesTheOutermostFilmBelowIt) {
  const geometry::FaceGeometry face = make_flat(10);
  const std::vector<plan::FilmLayout> films = {make_film(3, geometry::ChartBox{0.0, 1.0, 0.0, 1.0}),
                                               make_film(1, geometry::ChartBox{0.0, 0.45, 0.0, 0.45})};
  const FrameLayout layout = make_frame_layout(face.grid, films, face);
  const auto at = [&](int i, int j) { return layout.skin[static_cast<size_t>(face.grid.surface_index(i, j))]; };
  EXPECT_EQ(at(1, 1).film, 1) << "the other one lies deeper";
  EXPECT_EQ(at(1, 1).cell, 0);
  EXPECT_EQ(at(4, 1).film, 0) << "the outer film has no cell there";
  EXPECT_EQ(at(4, 1).cell, 0);
  EXPECT_EQ(at(9, 9).film, 0);
  EXPECT_EQ(at(9, 9).cell, 2);
  EXPECT_EQ(at(9, 1).film, -1) << "no film has a cell there";
}

TEST(FrameLayout, AFilmsMeshHasTheVerticesThatItsCellsTouch) {
  const geometry::FaceGeometry face = make_flat(4);
  film::FilmGrid grid = film::make_film_grid(geometry::ChartBox{}, 3, 1, {0, -1, 0});
  plan::FilmLayout film;
  film.level = 1;
  film.grid = grid;
  const FrameLayout layout = make_frame_layout(face.grid, {film}, face);
  EXPECT_THAT(layout.film_vertices.at(0), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(layout.film_corners.at(0), ElementsAre(0, 1, 5, 4, 2, 3, 7, 6));
  film.grid = film::make_film_grid(geometry::ChartBox{}, 3, 1, {-1, -1, 0});
  const FrameLayout alone = make_frame_layout(face.grid, {film}, face);
  EXPECT_THAT(alone.film_vertices.at(0), ElementsAre(2, 3, 6, 7));
  EXPECT_THAT(alone.film_corners.at(0), ElementsAre(0, 1, 3, 2));
}

}  // namespace
}  // namespace lipofill::simulation
