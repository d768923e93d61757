// The share of a zone that lies on the film, and what is said of the rest.

#include "core/plan/zone_share.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/unit/simulation/small_case.h"

namespace lipofill::plan {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr geometry::ChartBox kWhole{0.0, 1.0, 0.0, 1.0};

/// An ellipse of 12 x 8 mm on the square of 48 mm, its long axis along xi.
anatomy::PlacedRegion make_ellipse(double x_mm, double y_mm) {
  return {{x_mm * 1e-3, y_mm * 1e-3, 0.0}, Eigen::Vector3d::UnitX(), 12e-3, 8e-3};
}

double share_of(const anatomy::PlacedRegion& region, const geometry::ChartBox& box = kWhole) {
  return compute_zone_share(simulation::make_small_model()->geometry, region, box);
}

TEST(ZoneShare, IsThatOfTheEllipseInTheBox) {
  EXPECT_EQ(share_of(make_ellipse(24, 24)), 1.0);
  EXPECT_EQ(share_of(make_ellipse(-20, 24)), 0.0);
  // A chord at t half-axes from the middle cuts off (acos t - t sqrt(1 - t^2)) / pi of the area.
  for (const double x_mm : {0.7, 4.0, 9.0}) {
    const double t = x_mm / 12.0;
    const double beyond = (std::acos(t) - t * std::sqrt(1.0 - t * t)) / std::numbers::pi;
    EXPECT_NEAR(share_of(make_ellipse(x_mm, 24)), 1.0 - beyond, 0.02) << x_mm << " mm from the rim";
    EXPECT_NEAR(share_of(make_ellipse(24, 24), {0.5 - x_mm / 48.0, 1.0, 0.0, 1.0}), 1.0 - beyond, 0.02)
        << "the film's extent counts";
  }
}

/// What is said of a disc of 10 mm on the small square, taken for a face, at this distance from its
/// side.
struct Judged {
  FieldViolations violations;
  std::vector<std::string> remarks;
  explicit Judged(double from_side_mm, bool on_square = false) {
    model::FaceModel model = *simulation::make_small_model();
    model.is_square = on_square;
    model.geometry.axes = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
    const ZoneSpec zone{"cheek", Disc{geometry::ChartPoint{from_side_mm / 48.0, 0.5}, 10e-3}};
    judge_zone_share(model, FilmSpec(), zone, "zones[0]", violations, remarks);
  }
};

TEST(ZoneShare, LessThanAllIsSaidAndLessThanSixTenthsIsRefused) {
  EXPECT_TRUE(Judged(24).violations.empty());
  EXPECT_THAT(Judged(24).remarks, IsEmpty());
  const Judged in_part(5);
  EXPECT_TRUE(in_part.violations.empty());
  ASSERT_EQ(in_part.remarks.size(), 1u);
  EXPECT_THAT(in_part.remarks[0], HasSubstr("Zone cheek lies on the model with 0.8"));
  EXPECT_FALSE(Judged(1).violations.empty()) << "some 0.56 of it";
  EXPECT_TRUE(Judged(1, true).violations.empty()) << "half a disc on a square is meant";
}

}  // namespace
}  // namespace lipofill::plan
