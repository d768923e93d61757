#include "core/anatomy/regional_thickness.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "core/anatomy/regions.h"
#include "tests/unit/anatomy/faces.h"

namespace lipofill::anatomy {
namespace {

using ::testing::HasSubstr;

/// A flat cheek of 200 mm; the masseter's middle at (100, 100), its long axis upwards; no buccal
/// region nearby.
geometry::FaceGeometry make_flat_cheek() {
  geometry::FaceGeometrySpec spec;
  spec.region = geometry::SquareSpec{0.2, 0.2};
  spec.n_xi = spec.n_eta = 100;
  auto face = geometry::build_face_geometry(spec, nullptr);
  EXPECT_TRUE(face.ok());
  // Weights of the masseter: zygion 0.5, gonion 0.4, cheilion 0.1; of the middle of the buccal
  // region: cheilion 0.58.
  face->landmarks = {
      {"zygion_left", {0.12, 0.14, 0.0}}, {"gonion_left", {0.12, 0.06, 0.0}}, {"cheilion_left", {-0.08, 0.06, 0.0}}};
  return *std::move(face);
}

Eigen::VectorXd constant(const geometry::FaceGeometry& face, double value) {
  return Eigen::VectorXd::Constant(face.grid.nodes_per_level(), value);
}

/// Millimetres at the node nearest to a place of the flat cheek, in mm.
double at(const geometry::FaceGeometry& face, const Eigen::VectorXd& thickness, double x, double y) {
  return 1e3 *
         thickness[face.grid.surface_index(static_cast<int>(std::lround(x / 2)), static_cast<int>(std::lround(y / 2)))];
}

TEST(RegionalThickness, IsThePublishedFigureInTheRegionAndTheGeneralOneOutside) {
  const geometry::FaceGeometry face = make_flat_cheek();
  const auto thickness =
      compute_regional_thickness(face, TissueKind::kSubcutaneous, constant(face, 1.8e-3), constant(face, 4e-3));
  ASSERT_TRUE(thickness.ok()) << thickness.status();
  EXPECT_NEAR(at(face, *thickness, 100, 100), 4.25 - 1.8, 1e-12);
  EXPECT_NEAR(at(face, *thickness, 100, 128), 4.25 - 1.8, 1e-12) << "the long half-axis is 30 mm";
  EXPECT_NEAR(at(face, *thickness, 122, 100), 4.25 - 1.8, 1e-12) << "the short half-axis is 23 mm";
  EXPECT_NEAR(at(face, *thickness, 100, 146), 4.0, 1e-12);
  EXPECT_NEAR(at(face, *thickness, 136, 100), 4.0, 1e-12);
}

TEST(RegionalThickness, GoesOverHalfWayBetween) {
  const geometry::FaceGeometry face = make_flat_cheek();
  const auto thickness =
      compute_regional_thickness(face, TissueKind::kMuscle, constant(face, 0.0), constant(face, 6e-3));
  ASSERT_TRUE(thickness.ok());
  // rho = 38 / 30 = 1.2667 along the long axis: u = (1.5 - rho) / 0.5 = 0.46667, S = u^2 (3 - 2 u).
  const double u = (1.5 - 38.0 / 30.0) / 0.5;
  EXPECT_NEAR(at(face, *thickness, 100, 138), 6.0 + 4.0 * u * u * (3.0 - 2.0 * u), 1e-9);
  for (int j = 51; j < 100; ++j) {
    const double step = at(face, *thickness, 100, 2 * j + 2) - at(face, *thickness, 100, 2 * j);
    EXPECT_LE(step, 1e-12);
    EXPECT_GT(step, -0.9) << "it is smooth: 4 mm over 15 mm, at most 1.5 times as steep, in steps of 2 mm";
  }
}

TEST(RegionalThickness, TakesWhatTheLayersAboveLeave) {
  const geometry::FaceGeometry face = make_flat_cheek();
  const auto thickness =
      compute_regional_thickness(face, TissueKind::kSubcutaneous, constant(face, 3e-3), constant(face, 4e-3));
  ASSERT_TRUE(thickness.ok());
  EXPECT_NEAR(at(face, *thickness, 100, 100), 1.25, 1e-12);
  const auto none =
      compute_regional_thickness(face, TissueKind::kSubcutaneous, constant(face, 4.1e-3), constant(face, 4e-3));
  EXPECT_EQ(none.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(none.status().message()), HasSubstr("leaves 0.15 mm in the masseter region"));
}

TEST(RegionalThickness, NeedsAKindWithFiguresAndTheLandmarks) {
  geometry::FaceGeometry face = make_flat_cheek();
  const Eigen::VectorXd zero = constant(face, 0.0);
  EXPECT_THAT(std::string(compute_regional_thickness(face, TissueKind::kSmas, zero, zero).status().message()),
              HasSubstr("smas, which has no regional figure"));
  face.landmarks.erase("gonion_left");
  EXPECT_THAT(std::string(compute_regional_thickness(face, TissueKind::kMuscle, zero, zero).status().message()),
              HasSubstr("landmarks zygion, gonion and cheilion"));
}

TEST(RegionalThickness, OnTheFaceShippedTheCheekIsThickerBehindTheMouthThanOverTheMasseter) {
  auto region = read_face(LIPOFILL_SAMPLE_FACES, "half_face");
  region.corners = make_half_face_corners();
  const auto face = chart_face(std::move(region));
  ASSERT_TRUE(face.ok()) << face.status();
  const auto thickness =
      compute_regional_thickness(*face, TissueKind::kSubcutaneous, constant(*face, 1.8e-3), constant(*face, 2.7e-3));
  ASSERT_TRUE(thickness.ok()) << thickness.status();
  const auto at_middle_of = [&](const char* name) {
    const auto place = geometry::locate_in_chart(*face, find_region(name)->centre);
    EXPECT_TRUE(place.ok()) << place.status();
    const geometry::ScalarField field{31, 31, {thickness->begin(), thickness->end()}};
    return 1e3 * field.at(place->xi, place->eta);
  };
  EXPECT_NEAR(at_middle_of("masseter_left"), 2.45, 1e-6);
  EXPECT_NEAR(at_middle_of("buccal_left"), 3.02, 1e-6);
  EXPECT_GE(thickness->minCoeff(), 2.45e-3 - 1e-12);
  EXPECT_LE(thickness->maxCoeff(), 3.02e-3 + 1e-12);
}

}  // namespace
}  // namespace lipofill::anatomy
