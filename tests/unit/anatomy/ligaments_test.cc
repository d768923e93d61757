#include "core/anatomy/ligaments.h"

#include <gmock/gmock.h>

#include <cstdio>
#include <filesystem>

#include "core/base/field_violations.h"
#include "tests/unit/anatomy/faces.h"

namespace lipofill::anatomy {
namespace {

using ::testing::HasSubstr;

constexpr double kMm = 1e-3;

/// A flat face, x to the left, y up: menton 20 mm from the left side of a plate of 200 mm, gonion
/// straight beside it.
geometry::FaceGeometry make_flat_face() {
  geometry::FaceGeometrySpec spec;
  spec.region = geometry::SquareSpec{0.2, 0.2};
  spec.n_xi = spec.n_eta = 20;
  auto face = geometry::build_face_geometry(spec, nullptr);
  EXPECT_TRUE(face.ok());
  face->landmarks = {{"menton", {0.02, 0.02, 0.0}},
                     {"gonion_left", {0.12, 0.02, 0.0}},
                     {"zygion_left", {0.12, 0.09, 0.0}},
                     {"exocanthion_left", {0.07, 0.12, 0.0}},
                     {"cheilion_left", {0.04, 0.06, 0.0}}};
  return *std::move(face);
}

TEST(Ligaments, OfTheMandibleLieAsFarFromTheMidlineAndTheBorderAsMeasured) {
  const geometry::FaceGeometry face = make_flat_face();
  const struct {
    const char* name;
    double lateral;
    double above;
  } kCases[] = {
      {"mental_left", 9.1, 8.4}, {"medial_mandibular_left", 28.5, 8.4}, {"mandibular_osteocutaneous_left", 51.1, 9.1}};
  for (const auto& expected : kCases) {
    const auto placed = place_ligament(face, expected.name);
    ASSERT_TRUE(placed.ok()) << placed.status();
    ASSERT_EQ(placed->points.size(), 1u);
    EXPECT_NEAR(placed->points[0].xi * 200.0 - 20.0, expected.lateral, 0.1) << expected.name;
    EXPECT_NEAR(placed->points[0].eta * 200.0 - 20.0, expected.above, 0.1) << expected.name;
  }
}

TEST(Ligaments, TheBorderOfTheMandibleIsAParabola) {
  geometry::FaceGeometry face = make_flat_face();
  face.landmarks["gonion_left"] = {0.12, 0.12, 0.0};
  const auto placed = place_ligament(face, "mandibular_osteocutaneous_left");
  ASSERT_TRUE(placed.ok());
  // y = x^2 / a with a = 100 mm: an arc of s mm ends at x with s = x/2 sqrt(1 + 4 x^2/a^2) + a/4
  // asinh(2 x/a).
  const double x = placed->points[0].xi * 200.0 - 20.0;
  const double y = placed->points[0].eta * 200.0 - 20.0 - 9.1;
  EXPECT_NEAR(y, x * x / 100.0, 0.1);
  EXPECT_NEAR(0.5 * x * std::hypot(1.0, 0.02 * x) + 25.0 * std::asinh(0.02 * x), 51.1, 0.15);
}

TEST(Ligaments, FibresOfTheMasseterStandInARowBetweenZygomaAndMandible) {
  const geometry::FaceGeometry face = make_flat_face();
  const auto placed = place_ligament(face, "masseteric_cutaneous_left");
  ASSERT_TRUE(placed.ok());
  ASSERT_EQ(placed->points.size(), 5u);
  for (size_t k = 1; k < 5; ++k) EXPECT_LT(placed->points[k].eta, placed->points[k - 1].eta);
  EXPECT_NEAR(placed->points[2].xi, 0.5 * (placed->points[0].xi + placed->points[4].xi), 1e-9);
}

TEST(Ligaments, PointsOutsideTheChartAreLeftOutAndCounted) {
  geometry::FaceGeometry face = make_flat_face();
  face.landmarks["zygion_left"] = {0.12, 0.25, 0.0};
  const auto placed = place_ligament(face, "masseteric_cutaneous_left");
  ASSERT_TRUE(placed.ok());
  EXPECT_LT(placed->points.size(), 5u + 1u);
  EXPECT_EQ(placed->points.size() + static_cast<size_t>(placed->points_outside), 5u);
  face.landmarks["menton"] = {-0.30, 0.02, 0.0};
  face.landmarks["gonion_left"] = {-0.20, 0.02, 0.0};
  EXPECT_THAT(std::string(place_ligament(face, "mental_left").status().message()),
              HasSubstr("outside the charted region"));
}

TEST(Ligaments, AnUnknownNameListsTheKnownOnes) {
  const geometry::FaceGeometry face = make_flat_face();
  for (const char* name : {"mental", "knee_left", "", "_left"}) {
    const auto placed = place_ligament(face, name);
    ASSERT_EQ(placed.status().code(), absl::StatusCode::kInvalidArgument);
    for (const std::string& known : ligament_names()) {
      EXPECT_THAT(std::string(placed.status().message()), HasSubstr(known));
    }
  }
}

TEST(Ligaments, AMissingLandmarkIsNamed) {
  const geometry::FaceGeometry face = make_flat_face();
  EXPECT_THAT(std::string(place_ligament(face, "mental_right").status().message()), HasSubstr("gonion_right"));
}

TEST(Ligaments, StiffnessAndStrengthFollowThePublishedOrder) {
  const geometry::FaceGeometry face = make_flat_face();
  const LigamentFigures zygomatic = place_ligament(face, "zygomatic_left")->figures;
  const LigamentFigures mental = place_ligament(face, "mental_left")->figures;
  EXPECT_GT(zygomatic.stiffness, mental.stiffness);
  EXPECT_GT(zygomatic.breaking_force, mental.breaking_force);
  EXPECT_GT(mental.stiffness, 0.0);
}

/// Millimetres to the left, upwards and forwards of a landmark.
Eigen::Vector3d seen_from(const geometry::FaceGeometry& face, const char* landmark, const geometry::ChartPoint& place) {
  const Eigen::Vector3d d = geometry::skin_position(face.grid, place) - face.landmarks.at(landmark);
  return Eigen::Vector3d(d.dot(face.axes.left), d.dot(face.axes.up), d.dot(face.axes.forward)) / kMm;
}

void expect_all_in_place(const geometry::FaceGeometry& face) {
  for (const std::string& name : ligament_names()) {
    const auto placed = place_ligament(face, name + "_left");
    ASSERT_TRUE(placed.ok()) << name << ": " << placed.status();
    EXPECT_EQ(placed->points_outside, 0) << name;
    for (const geometry::ChartPoint& point : placed->points) {
      const Eigen::Vector3d m = seen_from(face, "menton", point);
      printf("%-28s %6.1f mm left, %6.1f up, %6.1f forward of menton\n", name.c_str(), m.x(), m.y(), m.z());
    }
  }
  const Eigen::Vector3d zygomatic = seen_from(face, "zygion_left", place_ligament(face, "zygomatic_left")->points[0]);
  EXPECT_LT(zygomatic.y(), 0.0);
  EXPECT_GT(zygomatic.z(), 10.0);
  EXPECT_LT(zygomatic.z(), 40.0);
  const auto osteocutaneous = place_ligament(face, "mandibular_osteocutaneous_left")->points[0];
  const Eigen::Vector3d from_gonion = seen_from(face, "gonion_left", osteocutaneous);
  EXPECT_GT(from_gonion.z(), 15.0) << "it lies on the body of the mandible, in front of the angle";
}

TEST(Ligaments, AllLieOnTheCheekOfTheFaceShipped) {
  auto region = read_face(LIPOFILL_SAMPLE_FACES, "half_face");
  region.corners = make_half_face_corners();
  const auto face = chart_face(std::move(region));
  ASSERT_TRUE(face.ok()) << face.status();
  expect_all_in_place(*face);
}

TEST(Ligaments, AllLieOnTheCheekOfARealScan) {
  if (!std::filesystem::exists(LIPOFILL_SHARED_DATA "/lps_head.obj")) {
    GTEST_SKIP() << "no real scans in " << LIPOFILL_SHARED_DATA;
  }
  auto region = read_face(LIPOFILL_SHARED_DATA, "lps_head");
  region.corners = make_half_face_corners();
  const auto face = chart_face(std::move(region));
  ASSERT_TRUE(face.ok()) << face.status();
  expect_all_in_place(*face);
}

}  // namespace
}  // namespace lipofill::anatomy
