// The numbering of the cells of several films, some on tissue and some with walls of their own.

#include "core/mechanics/film_cells.h"

#include <gtest/gtest.h>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::mechanics {
namespace {

TEST(FilmCells, NumbersFilmsOneAfterTheOtherAndTissueByItself) {
  const auto model = simulation::make_small_model();
  plan::FilmLayout on_tissue = *plan::place_film(*model, simulation::make_small_plan().films[0]);
  plan::FilmLayout rigid = on_tissue;
  rigid.wall = plan::FilmWallKind::kRigid;
  const std::vector<plan::FilmLayout> films{on_tissue, rigid, on_tissue};
  const FilmCells cells = number_cells(films);
  const int n = on_tissue.grid.n_cells();
  ASSERT_GT(n, 0);
  EXPECT_EQ(cells.n(), 3 * n);
  EXPECT_EQ(cells.gap_of_film, (std::vector<int>{0, -1, 1}));
  ASSERT_EQ(cells.on_tissue.size(), 2u * n);
  EXPECT_EQ(cells.film_of(0), 0);
  EXPECT_EQ(cells.film_of(n - 1), 0);
  EXPECT_EQ(cells.film_of(n), 1);
  EXPECT_EQ(cells.film_of(2 * n), 2);
  EXPECT_EQ(cells.film_of(3 * n - 1), 2);
  for (size_t row = 0; row < cells.on_tissue.size(); ++row) {
    const int expected = static_cast<int>(row) + (static_cast<int>(row) < n ? 0 : n);
    EXPECT_EQ(cells.on_tissue[row], expected);
    EXPECT_NE(cells.film_of(cells.on_tissue[row]), 1);
  }
}

TEST(FilmCells, GathersInTheirOrder) {
  const auto model = simulation::make_small_model();
  plan::FilmLayout rigid = *plan::place_film(*model, simulation::make_small_plan().films[0]);
  rigid.wall = plan::FilmWallKind::kRigid;
  plan::FilmLayout on_tissue = rigid;
  on_tissue.wall = plan::FilmWallKind::kTissue;
  const FilmCells cells = number_cells({rigid, on_tissue});
  SimulationState state;
  state.films.resize(2);
  state.films[0].pressure.setConstant(cells.n_of(0), 1.0);
  state.films[1].pressure = Eigen::VectorXd::LinSpaced(cells.n_of(1), 2.0, 3.0);
  Eigen::VectorXd all, part;
  cells.gather(state, &FilmState::pressure, all);
  ASSERT_EQ(all.size(), cells.n());
  EXPECT_EQ(all.head(cells.n_of(0)), state.films[0].pressure);
  EXPECT_EQ(all.tail(cells.n_of(1)), state.films[1].pressure);
  cells.gather_tissue_part(all, part);
  EXPECT_EQ(part, state.films[1].pressure);
}

}  // namespace
}  // namespace lipofill::mechanics
