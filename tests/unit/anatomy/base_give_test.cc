// Where bone lies beneath the face, and where none does.

#include "core/anatomy/base_give.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/anatomy/regions.h"
#include "tests/unit/anatomy/faces.h"

namespace lipofill::anatomy {
namespace {

geometry::FaceGeometry chart_sample_face() {
  geometry::ScanRegionSpec region = read_face(LIPOFILL_SAMPLE_FACES, "half_face");
  region.corners = make_half_face_corners();
  auto face = chart_face(std::move(region));
  EXPECT_TRUE(face.ok()) << face.status();
  return *std::move(face);
}

/// The give at the node that lies nearest to the middle of a region.
double give_at(const geometry::FaceGeometry& face, const Eigen::VectorXd& give, const char* region) {
  const auto placed = place_region(face, region);
  EXPECT_TRUE(placed.ok()) << placed.status();
  Eigen::Index nearest = 0;
  (face.grid.nodes.leftCols(face.grid.nodes_per_level()).colwise() - placed->centre)
      .colwise()
      .squaredNorm()
      .minCoeff(&nearest);
  return give[nearest];
}

TEST(BaseGive, BoneLiesUnderMasseterAndCheekboneAndNoneUnderTheCheek) {
  const geometry::FaceGeometry face = chart_sample_face();
  const auto give = compute_base_give(face);
  ASSERT_TRUE(give.has_value());
  EXPECT_EQ(give_at(face, *give, "buccal_left"), 1.0);
  EXPECT_EQ(give_at(face, *give, "masseter_left"), 0.0);
  EXPECT_EQ(give_at(face, *give, "zygomatic_left"), 0.0);
  EXPECT_GE(give->minCoeff(), 0.0);
  EXPECT_LE(give->maxCoeff(), 1.0);
}

TEST(BaseGive, GoesOverIntoBoneSmoothly) {
  geometry::FaceGeometrySpec spec;
  spec.region = geometry::SquareSpec{0.2, 0.2};
  spec.n_xi = spec.n_eta = 100;
  auto face = geometry::build_face_geometry(spec, nullptr);
  ASSERT_TRUE(face.ok());
  face->axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  face->landmarks = {
      {"zygion_left", {0.15, 0.16, 0.0}}, {"gonion_left", {0.15, 0.06, 0.0}}, {"cheilion_left", {0.06, 0.10, 0.0}}};
  const auto region = place_region_by_landmarks(*face, "buccal_left");
  ASSERT_TRUE(region.ok());
  const auto give = compute_base_give(*face);
  ASSERT_TRUE(give.has_value());
  double largest_step = 0.0;
  for (int j = 0; j <= 100; ++j) {
    for (int i = 0; i <= 100; ++i) {
      const int node = face->grid.surface_index(i, j);
      const double rho = region->compute_radius(face->grid.nodes.col(node), Eigen::Vector3d::UnitZ());
      const double u = std::clamp((1.3 - rho) / 0.6, 0.0, 1.0);
      ASSERT_NEAR((*give)[node], u * u * (3 - 2 * u), 1e-12) << "rho " << rho;
      if (i > 0) largest_step = std::max(largest_step, std::abs((*give)[node] - (*give)[node - 1]));
    }
  }
  EXPECT_LT(largest_step, 0.35) << "the blend of 10 mm or more spans several nodes 2 mm apart";
}

TEST(BaseGive, NothingIsSaidOfAFaceWithoutLandmarks) {
  geometry::FaceGeometry face = chart_sample_face();
  face.landmarks.clear();
  EXPECT_FALSE(compute_base_give(face).has_value());
}

}  // namespace
}  // namespace lipofill::anatomy
