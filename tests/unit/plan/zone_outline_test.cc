// The closed lines around a zone.

#include "core/plan/zone_outline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace lipofill::plan {
namespace {

/// A grid over the unit square; rows from the far side, "." no cell, "a" the first zone, "b" the
/// second.
film::FilmGrid draw_grid(const std::vector<std::string>& rows) {
  const int n_eta = static_cast<int>(rows.size());
  const int n_xi = static_cast<int>(rows[0].size());
  std::vector<int> zone_of_slot;
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    for (const char c : *row) zone_of_slot.push_back(c == '.' ? -1 : c - 'a');
  }
  return film::make_film_grid({}, n_xi, n_eta, zone_of_slot);
}

/// Area in cells by the shoelace formula: positive for anticlockwise loops.
double area_of(const film::FilmGrid& grid, const OutlineLoop& loop) {
  double twice = 0.0;
  for (size_t k = 0; k < loop.size(); ++k) {
    const int a = loop[k];
    const int b = loop[(k + 1) % loop.size()];
    const int n = grid.n_xi + 1;
    EXPECT_EQ(std::abs(a % n - b % n) + std::abs(a / n - b / n), 1) << "each step follows one edge of a cell";
    twice += (a % n) * (b / n) - (b % n) * (a / n);
  }
  return 0.5 * twice;
}

std::vector<double> areas_of(const film::FilmGrid& grid, int zone) {
  std::vector<double> areas;
  for (const OutlineLoop& loop : trace_zone_outline(grid, zone)) areas.push_back(area_of(grid, loop));
  return areas;
}

TEST(ZoneOutline, GoesAroundACellAnticlockwise) {
  const film::FilmGrid grid = draw_grid({"...", ".a.", "..."});
  const auto loops = trace_zone_outline(grid, 0);
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0], (OutlineLoop{grid.vertex(1, 1), grid.vertex(2, 1), grid.vertex(2, 2), grid.vertex(1, 2)}));
}

TEST(ZoneOutline, GoesAroundHolesTheOtherWay) {
  const film::FilmGrid grid = draw_grid({"aaa", "a.a", "aaa"});
  EXPECT_THAT(areas_of(grid, 0), ::testing::UnorderedElementsAre(9.0, -1.0));
}

TEST(ZoneOutline, TellsZonesAndPiecesApart) {
  const film::FilmGrid grid = draw_grid({"abb", "abb", "..a"});
  EXPECT_THAT(areas_of(grid, 0), ::testing::UnorderedElementsAre(2.0, 1.0));
  EXPECT_THAT(areas_of(grid, 1), ::testing::ElementsAre(4.0));
}

TEST(ZoneOutline, EndsWherePiecesTouchInACorner) {
  const film::FilmGrid grid = draw_grid({"a.a", ".a.", "a.a"});
  double sum = 0.0;
  for (const double area : areas_of(grid, 0)) sum += area;
  EXPECT_EQ(sum, 5.0);
}

}  // namespace
}  // namespace lipofill::plan
