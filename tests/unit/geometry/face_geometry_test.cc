#include "core/geometry/face_geometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <numbers>

#include "core/base/field_violations.h"
#include "core/geometry/surface_distance.h"
#include "tests/unit/geometry/test_surfaces.h"

namespace lipofill::geometry {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;

constexpr double kRadius = 0.08;

Eigen::Vector3d on_sphere(double longitude, double latitude) {
  return kRadius * Eigen::Vector3d(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                                   std::sin(latitude));
}

/// A square region of a sphere around +x, `half` radians to each side.
ScanRegionSpec make_sphere_region(int n, double half = 0.35) {
  ScanRegionSpec region;
  region.scan = make_sphere_cap(kRadius, 1.8, n);
  region.corners = {on_sphere(-half, -half), on_sphere(half, -half), on_sphere(half, half), on_sphere(-half, half)};
  return region;
}

FaceGeometrySpec make_spec(std::variant<SquareSpec, ScanRegionSpec> region, int n = 16) {
  FaceGeometrySpec spec;
  spec.region = std::move(region);
  spec.n_xi = n;
  spec.n_eta = n;
  spec.layers = {{ScalarField::constant(0.002), 1}, {ScalarField::constant(0.008), 2}};
  return spec;
}

std::vector<std::string> violated_fields(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : field_violations_of(status)) fields.push_back(violation.field);
  return fields;
}

void expect_violation(const FaceGeometrySpec& spec, const std::string& field, const std::string& description) {
  const auto geometry = build_face_geometry(spec, nullptr);
  ASSERT_FALSE(geometry.ok()) << field;
  EXPECT_EQ(geometry.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(violated_fields(geometry.status()), Contains(field));
  EXPECT_THAT(std::string(geometry.status().message()), HasSubstr(description));
}

TEST(Square, IsAnExactPlate) {
  FaceGeometrySpec spec = make_spec(SquareSpec{0.1, 0.05}, 10);
  spec.n_eta = 4;
  const auto geometry = build_face_geometry(spec, nullptr);
  ASSERT_TRUE(geometry.ok()) << geometry.status();
  const LayeredGrid& grid = geometry->grid;
  EXPECT_EQ(grid.n_levels(), 4);
  EXPECT_EQ(grid.n_hexahedra(), 3 * 40);
  const std::array<double, 4> depth = {0.0, -0.002, -0.006, -0.010};
  for (int level = 0; level < 4; ++level) {
    for (int j = 0; j <= 4; ++j) {
      for (int i = 0; i <= 10; ++i) {
        const Eigen::Vector3d expected(0.01 * i, 0.0125 * j, depth[level]);
        EXPECT_LT((grid.nodes.col(grid.node(level, i, j)) - expected).norm(), 1e-15);
      }
    }
  }
  EXPECT_DOUBLE_EQ(geometry->skin_area, 0.005);
  EXPECT_NEAR(grid.min_scaled_jacobian, 1.0, 1e-12);
  EXPECT_TRUE(geometry->riders.empty());
}

TEST(Square, NeedsNoLayers) {
  FaceGeometrySpec spec = make_spec(SquareSpec{0.1, 0.1}, 5);
  spec.layers.clear();
  const auto geometry = build_face_geometry(spec, nullptr);
  ASSERT_TRUE(geometry.ok());
  EXPECT_EQ(geometry->grid.n_levels(), 1);
  EXPECT_EQ(geometry->grid.nodes.cols(), 36);
}

TEST(Square, LocatesPositions) {
  const auto geometry = build_face_geometry(make_spec(SquareSpec{0.1, 0.05}, 7), nullptr);
  ASSERT_TRUE(geometry.ok());
  const auto place = locate_in_chart(*geometry, Eigen::Vector3d(0.033, 0.041, 0.004));
  ASSERT_TRUE(place.ok()) << place.status();
  EXPECT_NEAR(place->xi, 0.33, 1e-9);
  EXPECT_NEAR(place->eta, 0.82, 1e-9);
  EXPECT_LT((skin_position(geometry->grid, *place) - Eigen::Vector3d(0.033, 0.041, 0.0)).norm(), 1e-12);
}

TEST(FaceGeometry, RefusesNumbersOutOfBounds) {
  const auto broken = [](const std::function<void(FaceGeometrySpec&)>& change) {
    FaceGeometrySpec spec = make_spec(SquareSpec{0.1, 0.1}, 10);
    change(spec);
    return spec;
  };
  expect_violation(broken([](auto& s) { s.n_xi = 1; }), "n_xi", "must be in [2, 512]");
  expect_violation(broken([](auto& s) { s.n_eta = 513; }), "n_eta", "513");
  expect_violation(broken([](auto& s) { s.n_xi = s.n_eta = 512; }), "n_xi", "at most 200000");
  expect_violation(broken([](auto& s) { s.layers[1].thickness = ScalarField::constant(-0.001); }),
                   "layers[1].thickness_mm", "-1 mm");
  expect_violation(broken([](auto& s) { s.layers[0].thickness = ScalarField::constant(0.0); }),
                   "layers[0].thickness_mm", "0 mm");
  expect_violation(broken([](auto& s) { s.layers[0].thickness = ScalarField::constant(0.2); }),
                   "layers[0].thickness_mm", "200 mm");
  expect_violation(broken([](auto& s) { s.layers[0].thickness = ScalarField::constant(std::nan("")); }),
                   "layers[0].thickness_mm", "finite");
  expect_violation(broken([](auto& s) { s.layers[0].thickness.n_xi = 3; }), "layers[0].thickness_mm", "values");
  expect_violation(broken([](auto& s) { s.layers[0].elements_through = -1; }), "layers[0].elements_through", "[1, 16]");
  expect_violation(broken([](auto& s) { s.layers[0].elements_through = 17; }), "layers[0].elements_through", "17");
  expect_violation(broken([](auto& s) { s.layers.resize(9, s.layers[0]); }), "layers", "at most 8");
  expect_violation(broken([](auto& s) { s.region = SquareSpec{0.0001, 0.1}; }), "square.length_xi_mm", "[1, 1000]");
  expect_violation(broken([](auto& s) { s.region = SquareSpec{0.1, std::nan("")}; }), "square.length_eta_mm", "nan");
}

TEST(FaceGeometry, ReportsProgressAndStopsWhenTold) {
  double last = -1.0;
  const auto watched = build_face_geometry(make_spec(make_sphere_region(24)), [&](double fraction, const char* stage) {
    EXPECT_GT(fraction, last);
    EXPECT_STRNE(stage, "");
    last = fraction;
    return true;
  });
  EXPECT_TRUE(watched.ok());
  EXPECT_EQ(last, 1.0);
  for (const double stop_at : {0.0, 0.5, 0.8}) {
    const auto stopped = build_face_geometry(make_spec(make_sphere_region(24)),
                                             [&](double fraction, const char*) { return fraction < stop_at; });
    EXPECT_EQ(stopped.status().code(), absl::StatusCode::kCancelled);
  }
}

TEST(ScanRegion, OnACylinderHasItsAreaToSecondOrder) {
  const auto on_cylinder = [](double angle, double z) {
    return Eigen::Vector3d(0.06 * std::cos(angle), 0.06 * std::sin(angle), z);
  };
  const double exact = 0.06 * 0.8 * 0.05;
  std::vector<double> error;
  for (const int n : {20, 40, 80}) {
    ScanRegionSpec region;
    region.scan = make_sheet(n, n, [&](double u, double v) { return on_cylinder(2.5 * (u - 0.5), 0.12 * (v - 0.5)); });
    region.corners = {on_cylinder(-0.4, -0.025), on_cylinder(0.4, -0.025), on_cylinder(0.4, 0.025),
                      on_cylinder(-0.4, 0.025)};
    const auto geometry = build_face_geometry(make_spec(region, n / 2), nullptr);
    ASSERT_TRUE(geometry.ok()) << geometry.status();
    error.push_back(std::abs(geometry->skin_area / exact - 1.0));
  }
  EXPECT_LT(error.back(), 1e-3);
  EXPECT_GT(std::log2(error[0] / error[1]), 1.7);
  EXPECT_GT(std::log2(error[1] / error[2]), 1.7);
}

/// Area on the sphere inside the rim of the chart, by the excess of the angles of that polygon.
double compute_area_inside_rim(const LayeredGrid& grid) {
  std::vector<Eigen::Vector3d> rim;
  for (int i = 0; i < grid.n_xi; ++i) rim.push_back(grid.nodes.col(grid.node(0, i, 0)).normalized());
  for (int j = 0; j < grid.n_eta; ++j) rim.push_back(grid.nodes.col(grid.node(0, grid.n_xi, j)).normalized());
  for (int i = grid.n_xi; i > 0; --i) rim.push_back(grid.nodes.col(grid.node(0, i, grid.n_eta)).normalized());
  for (int j = grid.n_eta; j > 0; --j) rim.push_back(grid.nodes.col(grid.node(0, 0, j)).normalized());
  const size_t n = rim.size();
  double excess = -(static_cast<double>(n) - 2.0) * std::numbers::pi;
  for (size_t k = 0; k < n; ++k) {
    const Eigen::Vector3d& p = rim[k];
    const Eigen::Vector3d to_next = p.cross(rim[(k + 1) % n]);
    const Eigen::Vector3d to_last = p.cross(rim[(k + n - 1) % n]);
    const double angle = std::atan2(p.dot(to_next.cross(to_last)), to_next.dot(to_last));
    excess += angle < 0.0 ? angle + 2.0 * std::numbers::pi : angle;
  }
  return kRadius * kRadius * excess;
}

TEST(ScanRegion, OnASphereIsSmoothOutwardAndTrueToSecondOrder) {
  std::vector<double> area_error;
  std::vector<double> position_error;
  for (const int n : {24, 48, 96}) {
    const auto geometry = build_face_geometry(make_spec(make_sphere_region(n), n / 2), nullptr);
    ASSERT_TRUE(geometry.ok()) << geometry.status();
    const LayeredGrid& grid = geometry->grid;
    area_error.push_back(std::abs(geometry->skin_area / compute_area_inside_rim(grid) - 1.0));
    const auto skin = grid.nodes.leftCols(grid.nodes_per_level());
    position_error.push_back((skin.colwise().norm().array() - kRadius).abs().maxCoeff());
    EXPECT_GT(grid.min_scaled_jacobian, 0.85);
    for (int j = 0; j < grid.n_eta; ++j) {
      for (int i = 0; i < grid.n_xi; ++i) {
        const Eigen::Vector3d a = grid.nodes.col(grid.node(0, i, j));
        const Eigen::Vector3d normal =
            (grid.nodes.col(grid.node(0, i + 1, j)) - a).cross(grid.nodes.col(grid.node(0, i, j + 1)) - a).normalized();
        EXPECT_GT(normal.dot(a.normalized()), 0.99);
      }
    }
    for (int level = 1; level < grid.n_levels(); ++level) {
      EXPECT_LT(grid.nodes.col(grid.node(level, 3, 3)).norm(), grid.nodes.col(grid.node(level - 1, 3, 3)).norm());
    }
  }
  EXPECT_LT(position_error.back(), 0.1e-3);
  EXPECT_GT(std::log2(position_error[0] / position_error[1]), 1.6);
  EXPECT_GT(std::log2(position_error[1] / position_error[2]), 1.7);
  EXPECT_GT(std::log2(area_error[0] / area_error[2]), 3.0);
}

TEST(ScanRegion, CarriesTheScanVerticesInside) {
  const ScanRegionSpec region = make_sphere_region(40);
  const auto geometry = build_face_geometry(make_spec(region), nullptr);
  ASSERT_TRUE(geometry.ok());
  EXPECT_EQ(geometry->scan.points, region.scan.points);
  EXPECT_EQ(geometry->scan.triangles, region.scan.triangles);
  const double spacing = 1.8 / 40 * kRadius;
  EXPECT_NEAR(static_cast<double>(geometry->riders.size()), geometry->skin_area / (spacing * spacing), 30.0);
  EXPECT_LT(geometry->max_rider_distance, 0.2e-3);
  int last = -1;
  for (const Rider& rider : geometry->riders) {
    EXPECT_GT(rider.vertex, last);
    last = rider.vertex;
    EXPECT_GE(std::min(rider.place.xi, rider.place.eta), 0.0);
    EXPECT_LE(std::max(rider.place.xi, rider.place.eta), 1.0);
    const Eigen::Vector3d vertex = geometry->scan.points.col(rider.vertex);
    EXPECT_LT((skin_position(geometry->grid, rider.place) - vertex).norm(), geometry->max_rider_distance + 1e-12);
  }
}

TEST(ScanRegion, LocatesCornersNodesAndLandmarks) {
  ScanRegionSpec region = make_sphere_region(40);
  region.landmarks = {{"a", on_sphere(-0.1, 0.1)}, {"b", on_sphere(0.2, 0.1)}};
  const auto geometry = build_face_geometry(make_spec(region), nullptr);
  ASSERT_TRUE(geometry.ok());
  const LayeredGrid& grid = geometry->grid;
  for (int j = 0; j <= grid.n_eta; j += 2) {
    for (int i = 0; i <= grid.n_xi; ++i) {
      const auto place = locate_in_chart(*geometry, Eigen::Vector3d(grid.nodes.col(grid.node(0, i, j))));
      ASSERT_TRUE(place.ok()) << i << " " << j << " " << place.status();
      EXPECT_NEAR(place->xi, static_cast<double>(i) / grid.n_xi, 1e-7);
      EXPECT_NEAR(place->eta, static_cast<double>(j) / grid.n_eta, 1e-7);
    }
  }
  const auto middle = locate_in_chart(*geometry, LandmarkPoint{{{"a", 1.0}, {"b", 3.0}}, 0.002, 0.0, 0.0});
  ASSERT_TRUE(middle.ok()) << middle.status();
  EXPECT_GT(skin_position(grid, *middle).normalized().dot(on_sphere(0.125, 0.1).normalized()), 0.9998);

  const auto complaint = [&](const SkinPoint& point) {
    const auto place = locate_in_chart(*geometry, point);
    return place.ok() ? std::string("located") : std::string(place.status().message());
  };
  EXPECT_EQ(complaint(ChartPoint{1.0, 0.0}), "located");
  EXPECT_THAT(complaint(ChartPoint{1.01, 0.0}), HasSubstr("outside the region"));
  EXPECT_THAT(complaint(ChartPoint{std::nan(""), 0.0}), HasSubstr("outside the region"));
  EXPECT_THAT(complaint(on_sphere(0.5, 0.0)), HasSubstr("outside the region"));
  EXPECT_THAT(complaint(Eigen::Vector3d(1.2 * on_sphere(0.0, 0.0))), HasSubstr("16.0 mm from the outer skin"));
  EXPECT_THAT(complaint(LandmarkPoint{{{"nose", 1.0}}, 0, 0, 0}), HasSubstr("'nose'"));
  EXPECT_THAT(complaint(LandmarkPoint{}), HasSubstr("add up to 0"));
  EXPECT_THAT(complaint(Eigen::Vector3d(0, std::numeric_limits<double>::infinity(), 0)), HasSubstr("finite"));
}

TEST(ScanRegion, IsTheSameEveryTime) {
  const FaceGeometrySpec spec = make_spec(make_sphere_region(30));
  const auto first = build_face_geometry(spec, nullptr);
  const auto second = build_face_geometry(spec, nullptr);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first->grid.nodes, second->grid.nodes);
  EXPECT_EQ(first->riders.size(), second->riders.size());
}

TEST(ScanRegion, FillsSmallHolesAndTurnsAnInsideOutScan) {
  ScanRegionSpec region = make_sphere_region(40);
  const int middle = 2 * (20 * 40 + 20);
  region.scan.triangles.erase(region.scan.triangles.begin() + middle, region.scan.triangles.begin() + middle + 4);
  region.scan = turn_over(region.scan);
  const auto geometry = build_face_geometry(make_spec(region), nullptr);
  ASSERT_TRUE(geometry.ok()) << geometry.status();
  EXPECT_THAT(geometry->scan_remarks, Contains(HasSubstr("1 hole around the region filled")));
  EXPECT_THAT(geometry->scan_remarks, Contains(HasSubstr("inside out")));
  const auto skin = geometry->grid.nodes.leftCols(geometry->grid.nodes_per_level());
  EXPECT_LT((skin.colwise().norm().array() - kRadius).abs().maxCoeff(), 0.5e-3);
}

TEST(ScanRegion, StaysOnTheOuterOfTwoShells) {
  ScanRegionSpec region = make_sphere_region(40);
  region.scan = put_together(make_sphere_cap(kRadius - 0.004, 1.8, 40), region.scan);
  const auto geometry = build_face_geometry(make_spec(region), nullptr);
  ASSERT_TRUE(geometry.ok()) << geometry.status();
  const auto skin = geometry->grid.nodes.leftCols(geometry->grid.nodes_per_level());
  EXPECT_LT((skin.colwise().norm().array() - kRadius).abs().maxCoeff(), 0.5e-3);
  for (const Rider& rider : geometry->riders) EXPECT_GE(rider.vertex, 41 * 41);
}

TEST(ScanRegion, RefusesCornersThatMakeNoRegion) {
  const auto with_corners = [](std::array<SkinPoint, 4> corners) {
    ScanRegionSpec region = make_sphere_region(40);
    region.corners = std::move(corners);
    return make_spec(region);
  };
  const Eigen::Vector3d a = on_sphere(-0.35, -0.35);
  const Eigen::Vector3d b = on_sphere(0.35, -0.35);
  const Eigen::Vector3d c = on_sphere(0.35, 0.35);
  const Eigen::Vector3d d = on_sphere(-0.35, 0.35);
  expect_violation(with_corners({a, d, c, b}), "scan_region.corners", "clockwise");
  expect_violation(with_corners({a, c, b, d}), "scan_region.corners", "cross");
  expect_violation(with_corners({a, b, on_sphere(-0.1, -0.1), d}), "scan_region.corners[2]", "convex");
  expect_violation(with_corners({a, b, Eigen::Vector3d(1.3 * c), d}), "scan_region.corners[2]",
                   "24.0 mm from the outer skin");
  expect_violation(with_corners({a, a, c, d}), "scan_region.corners", "side of 0.0 mm");
  expect_violation(with_corners({a, b, Eigen::Vector3d(0, 0, 9), d}), "scan_region.corners", "must be in [5, 300] mm");
  expect_violation(with_corners({ChartPoint{0, 0}, b, c, d}), "scan_region.corners[0]", "chart point");
  expect_violation(with_corners({a, LandmarkPoint{{{"gonion_left", 1.0}}, 0, 0, 0}, c, d}), "scan_region.corners[1]",
                   "'gonion_left'");
  expect_violation(with_corners({a, b, c, Eigen::Vector3d(std::nan(""), 0, 0)}), "scan_region.corners[3]", "finite");
}

TEST(ScanRegion, RefusesCornersOnInnerSurfaces) {
  ScanRegionSpec region = make_sphere_region(40);
  region.scan = put_together(make_sphere_cap(kRadius - 0.030, 1.8, 40), region.scan);
  const double inner = (kRadius - 0.030) / kRadius;
  for (SkinPoint& corner : region.corners) corner = Eigen::Vector3d(inner * std::get<Eigen::Vector3d>(corner));
  expect_violation(make_spec(region), "scan_region.corners[0]", "inner surface");
}

TEST(ScanRegion, RefusesARegionOverAWideHole) {
  ScanRegionSpec region = make_sphere_region(40);
  std::erase_if(region.scan.triangles, [&](const auto& triangle) {
    return (region.scan.points.col(triangle[0]) - on_sphere(0, 0)).norm() < 0.014;
  });
  const auto geometry = build_face_geometry(make_spec(region), nullptr);
  EXPECT_EQ(geometry.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(geometry.status().message()), HasSubstr("hole wider than 15 mm, near ("));
}

TEST(ScanRegion, RefusesCornersOnSeparatePieces) {
  ScanRegionSpec region = make_sphere_region(40);
  std::erase_if(region.scan.triangles,
                [&](const auto& triangle) { return std::abs(region.scan.points(1, triangle[0])) < 0.004; });
  expect_violation(make_spec(region), "scan_region.corners", "do not hang together");
}

TEST(ScanRegion, RefusesLandmarksAxesAndScansThatCannotBe) {
  ScanRegionSpec region = make_sphere_region(40);
  region.landmarks["gonion_left"] = 1.5 * on_sphere(0, 0);
  expect_violation(make_spec(region), "scan_region.landmarks_mm[\"gonion_left\"]", "40.0 mm from the surface");
  region.landmarks["menton"] = Eigen::Vector3d(std::nan(""), 0, 0);
  expect_violation(make_spec(region), "scan_region.landmarks_mm[\"menton\"]", "finite");

  region = make_sphere_region(40);
  region.axes = HeadAxes{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitZ()};
  expect_violation(make_spec(region), "scan_region.axes", "left = up x forward");

  region = make_sphere_region(40);
  region.scan.triangles.clear();
  expect_violation(make_spec(region), "scan_region.scan", "no triangle");
  region = make_sphere_region(40);
  region.scan.triangles[5][1] = 99999;
  expect_violation(make_spec(region), "scan_region.scan", "99999");
  region = make_sphere_region(40);
  region.scan.points(1, 7) = std::nan("");
  expect_violation(make_spec(region), "scan_region.scan", "finite");
}

TEST(ScanRegion, NeedsAxesOnlyForOffsets) {
  ScanRegionSpec region = make_sphere_region(40);
  region.landmarks["a"] = on_sphere(-0.35, -0.35);
  region.corners[0] = LandmarkPoint{{{"a", 1.0}}, 0, 0, 0};
  EXPECT_TRUE(build_face_geometry(make_spec(region), nullptr).ok());
  region.corners[0] = LandmarkPoint{{{"a", 1.0}}, 0.001, 0, 0};
  const auto geometry = build_face_geometry(make_spec(region), nullptr);
  EXPECT_EQ(geometry.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(geometry.status().message()), HasSubstr("head axes"));
}

}  // namespace
}  // namespace lipofill::geometry
