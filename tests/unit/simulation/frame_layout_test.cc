#include "core/simulation/frame_layout.h"

#include <gmock/gmock.h>

#include <numeric>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::simulation {
namespace {

using ::testing::ElementsAre;

/// Two films of one half of the chart each and one below them, as a plan may name them: the deep
/// one first.
struct Layered {
  std::shared_ptr<const model::FaceModel> model = make_small_model();
  std::vector<plan::FilmLayout> films;

  void add(const std::string& below_layer, const geometry::ChartBox& extent, int n) {
    plan::FilmSpec film = make_small_plan().films[0];
    film.below_layer = below_layer;
    film.extent = extent;
    film.zones = {{"all", extent}};
    film.n_xi = film.n_eta = n;
    auto placed = plan::place_film(*model, film);
    ASSERT_TRUE(placed.ok()) << placed.status();
    films.push_back(*std::move(placed));
  }

  FrameLayout layout() const { return make_frame_layout(model->geometry.grid, films, model->geometry); }
};

TEST(FrameLayout, ItsOwnSkinLiesOnItsOwnNodes) {
  const Layered face;
  const FrameLayout layout = face.layout();
  const geometry::LayeredGrid& grid = face.model->geometry.grid;
  ASSERT_EQ(static_cast<int>(layout.skin.size()), (grid.n_xi + 1) * (grid.n_eta + 1));
  for (const SkinPoint& point : layout.skin) {
    double at_the_node = 0.0;
    for (size_t k = 0; k < 4; ++k) at_the_node += point.nodes[k] == point.vertex ? point.weights[k] : 0.0;
    EXPECT_NEAR(at_the_node, 1.0, 1e-12);
    EXPECT_EQ(point.film, -1);
    EXPECT_EQ(point.cell, -1);
  }
}

TEST(FrameLayout, ASkinWithOtherNodesLiesBetweenThose) {
  const Layered face;
  model::FaceModelSpec finer = make_small_model_spec();
  finer.n_xi = finer.n_eta = 18;
  const auto shown = model::build_face_model(finer, nullptr);
  ASSERT_TRUE(shown.ok()) << shown.status();
  const geometry::LayeredGrid& grid = face.model->geometry.grid;
  const geometry::LayeredGrid& other = (*shown)->geometry.grid;
  const FrameLayout layout = make_frame_layout(grid, {}, (*shown)->geometry);
  ASSERT_EQ(layout.skin.size(), 19u * 19u);
  for (int j = 0; j <= 18; ++j) {
    for (int i = 0; i <= 18; ++i) {
      const SkinPoint& point = layout.skin[static_cast<size_t>(j * 19 + i)];
      EXPECT_EQ(point.vertex, other.surface_index(i, j));
      EXPECT_NEAR(std::accumulate(point.weights.begin(), point.weights.end(), 0.0), 1.0, 1e-12);
      double x = 0.0, y = 0.0;
      for (int n = 0; n <= 12 * 13 + 12; ++n) {
        for (size_t k = 0; k < 4; ++k) {
          if (point.nodes[k] != grid.surface_index(n % 13, n / 13)) continue;
          x += point.weights[k] * (n % 13) / 12.0;
          y += point.weights[k] * (n / 13) / 12.0;
        }
      }
      EXPECT_NEAR(x, i / 18.0, 1e-12);
      EXPECT_NEAR(y, j / 18.0, 1e-12);
    }
  }
}

TEST(FrameLayout, ShowsTheOutermostFilmBelowASkinPoint) {
  model::FaceModelSpec spec = make_small_model_spec();
  spec.layers.push_back({"deep", {geometry::ScalarField::constant(4e-3), 1}, {2e5, 0.45, 1050.0}});
  Layered face;
  face.model = *model::build_face_model(spec, nullptr);
  face.add("muscle", geometry::ChartBox{0.0, 1.0, 0.0, 1.0}, 6);
  face.add("skin", geometry::ChartBox{0.0, 0.5, 0.0, 1.0}, 3);
  const FrameLayout layout = face.layout();
  const auto film_at = [&](int i, int j) { return layout.skin[static_cast<size_t>(j * 13 + i)].film; };
  EXPECT_EQ(film_at(3, 6), 1);
  EXPECT_EQ(film_at(9, 6), 0);
  for (const SkinPoint& point : layout.skin) {
    if (point.film < 0) continue;
    EXPECT_LT(point.cell, face.films[static_cast<size_t>(point.film)].grid.n_cells());
    EXPECT_GE(point.cell, 0);
  }
}

TEST(FrameLayout, AFilmHasTheVerticesThatItsCellsTouch) {
  Layered face;
  face.add("skin", geometry::ChartBox{0.25, 0.75, 0.25, 0.75}, 2);
  const FrameLayout layout = face.layout();
  ASSERT_EQ(layout.film_vertices.size(), 1u);
  EXPECT_THAT(layout.film_vertices[0], ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_THAT(layout.film_corners[0], ElementsAre(0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7));
}

}  // namespace
}  // namespace lipofill::simulation
