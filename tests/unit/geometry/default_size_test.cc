// Sizes of grids that nobody chose.

#include "core/geometry/default_size.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/face_geometry.h"
#include "core/geometry/surface_chart.h"

namespace lipofill::geometry {
namespace {

Footprint make_footprint(double half_length, double half_width) {
  Footprint footprint;
  footprint.half_length = half_length;
  footprint.half_width = half_width;
  return footprint;
}

TEST(DefaultSize, QuadrilateralsAreAThirdOfASeptumWideAndTheirNumberIsEven) {
  const GridSize size = choose_grid_size({0.083, 0.051}, {});
  EXPECT_EQ(size.n_xi, 62);
  EXPECT_EQ(size.n_eta, 38);
}

TEST(DefaultSize, NarrowZonesGetNarrowerOnes) {
  EXPECT_EQ(choose_grid_size({0.04, 0.03}, {make_footprint(11e-3, 5e-3), make_footprint(20e-3, 20e-3)}).n_xi, 32);
  EXPECT_EQ(choose_grid_size({0.04, 0.03}, {make_footprint(11e-3, 2e-3)}).n_xi, 40) << "1 mm at least";
}

TEST(DefaultSize, LargeRegionsGetWiderOnes) {
  const GridSize size = choose_grid_size({0.16, 0.12}, {make_footprint(11e-3, 5e-3)});
  EXPECT_NEAR(size.n_xi * size.n_eta, kMostDefaultQuadrilaterals, 0.05 * kMostDefaultQuadrilaterals);
  EXPECT_NEAR(size.n_xi / 160.0, size.n_eta / 120.0, 0.02);
}

TEST(DefaultSize, NoHexahedronIsMoreThanTwiceAsThickAsItIsWide) {
  EXPECT_EQ(choose_elements_through(4e-3, 2e-3), 1);
  EXPECT_EQ(choose_elements_through(4.1e-3, 2e-3), 2);
  EXPECT_EQ(choose_elements_through(4.25e-3, 1e-3), 3);
  EXPECT_EQ(choose_elements_through(30e-3, 1e-3), 4) << "4 at most";
}

TEST(DefaultSize, WhatIsLeftOutIsChosenAndWhatIsGivenStays) {
  FaceGeometrySpec spec;
  spec.region = SquareSpec{0.06, 0.04};
  spec.n_xi = 15;
  spec.layers = {{ScalarField::constant(2e-3), 0}, {ScalarField::constant(14e-3), 0}, {ScalarField::constant(9e-3), 1}};
  const auto face = build_face_geometry(spec, nullptr);
  ASSERT_TRUE(face.ok()) << face.status();
  EXPECT_EQ(face->grid.n_xi, 15);
  EXPECT_EQ(face->grid.n_eta, 30);
  EXPECT_EQ(face->grid.elements_through, (std::vector<int>{1, 3, 1})) << "the mean width is 2.7 mm";
}

}  // namespace
}  // namespace lipofill::geometry
