#include "core/step/tissue_entry.h"

#include <gtest/gtest.h>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::step {
namespace {

/// A film of 6 x 6 cells whose first cell fat has entered.
struct EntryCase {
  std::shared_ptr<const model::FaceModel> model = simulation::make_small_model();
  plan::FilmLayout layout = *plan::place_film(*model, simulation::make_small_plan().films[0]);
  mechanics::FilmState film;

  EntryCase() {
    layout.connective_tissue.entry_pressure = 500.0;
    film.pressure = Eigen::VectorXd::Constant(36, 600.0);
    film.is_entered = Eigen::VectorXd::Unit(36, 0);
  }
};

TEST(TissueEntry, GoesOneCellFurtherInEveryDirection) {
  EntryCase c;
  EXPECT_TRUE(enter_cells_beside_pressure(c.layout, c.film));
  EXPECT_EQ(c.film.is_entered.sum(), 3.0) << "a corner has two neighbours";
  EXPECT_TRUE(enter_cells_beside_pressure(c.layout, c.film));
  EXPECT_EQ(c.film.is_entered.sum(), 6.0);
}

TEST(TissueEntry, WaitsForThePressureOfACellThatIsEntered) {
  EntryCase c;
  c.film.pressure[0] = 500.0;
  EXPECT_FALSE(enter_cells_beside_pressure(c.layout, c.film)) << "whatever the pressure beside it";
  EXPECT_EQ(c.film.is_entered.sum(), 1.0);
}

TEST(TissueEntry, LeavesOpenFilmsAlone) {
  EntryCase c;
  c.film.is_entered.resize(0);
  EXPECT_FALSE(enter_cells_beside_pressure(c.layout, c.film));
  EXPECT_EQ(c.film.is_entered.size(), 0);
}

}  // namespace
}  // namespace lipofill::step
