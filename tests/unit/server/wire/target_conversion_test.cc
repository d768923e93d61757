#include "server/wire/target_conversion.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/base/field_violations.h"

namespace lipofill::server {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> fields_of(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : field_violations_of(status)) fields.push_back(violation.field);
  return fields;
}

TEST(TargetRequest, OfAMirroredSideNeedsLandmarksAndTheSide) {
  v1::TargetSpec spec;
  spec.set_scan("patients/p/scans/s");
  spec.mutable_mirrored();
  EXPECT_THAT(fields_of(to_target_request(spec).status()), ElementsAre("mirrored.healthy_side", "landmarks_mm"));
  spec.mutable_mirrored()->set_healthy_side(v1::RIGHT);
  v1::Vector3& nasion = (*spec.mutable_landmarks_mm())["nasion"];
  nasion.set_x(1.0), nasion.set_y(2.0), nasion.set_z(3.0);
  const auto request = to_target_request(spec);
  ASSERT_TRUE(request.ok()) << request.status();
  EXPECT_EQ(request->healthy_side, planning::FaceSide::kRight);
  EXPECT_TRUE(request->landmarks.at("nasion").isApprox(Eigen::Vector3d(1e-3, 2e-3, 3e-3)));
}

TEST(TargetRequest, SaysWhatIsMissing) {
  EXPECT_THAT(fields_of(to_target_request({}).status()), ElementsAre("scan", "source"));
  v1::TargetSpec spec;
  spec.set_scan("s");
  spec.mutable_surface();
  EXPECT_THAT(fields_of(to_target_request(spec).status()), ElementsAre("surface.scan"));
  spec.mutable_surface()->set_scan("t");
  spec.mutable_surface()->set_placement(v1::FaceSurface::IN_PLACE);
  EXPECT_EQ(to_target_request(spec)->placement, planning::SurfacePlacement::kInPlace);
  for (int k = 0; k < 101; ++k) {
    v1::Vector3& place = (*spec.mutable_landmarks_mm())[std::to_string(k)];
    place.set_x(0.0), place.set_y(0.0), place.set_z(0.0);
  }
  EXPECT_THAT(fields_of(to_target_request(spec).status()), ElementsAre("landmarks_mm"));
}

TEST(TargetReport, HasTheMotionRowByRowInMillimetres) {
  planning::Target target;
  target.registration.emplace();
  target.registration->motion.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  target.registration->motion.translation << 0.001, 0.0, -0.002;
  target.registration->expected_error = 2e-4;
  v1::TargetSpec spec;
  spec.mutable_surface()->set_scan("t");
  const v1::TargetReport report = to_target_report(spec, target);
  EXPECT_THAT(report.registration().rotation(), ElementsAre(0, -1, 0, 1, 0, 0, 0, 0, 1));
  EXPECT_DOUBLE_EQ(report.registration().translation_mm().z(), -2.0);
  EXPECT_DOUBLE_EQ(report.registration().expected_error_mm(), 0.2);
  EXPECT_EQ(report.registration().start(), "shape");
  EXPECT_EQ(report.surface_scan(), "t");
  EXPECT_FALSE(report.has_plane());
}

TEST(Deficit, HasDistancesWhereTheyAreAskedFor) {
  planning::Deficit deficit;
  deficit.distances = {-0.002, std::nan("")};
  deficit.all.volume = {1e-6, 2e-6};
  deficit.all.area = 1e-4;
  deficit.regions.push_back({"malar_left", 2e-4, {}, {}, 0.001, 7});
  const v1::Deficit message = to_deficit(deficit, true);
  ASSERT_EQ(message.distance_mm_size(), 2);
  EXPECT_FLOAT_EQ(message.distance_mm(0), -2.0F);
  EXPECT_TRUE(std::isnan(message.distance_mm(1)));
  EXPECT_DOUBLE_EQ(message.all().volume().excess_ml(), 2.0);
  EXPECT_DOUBLE_EQ(message.all().area_cm2(), 1.0);
  EXPECT_EQ(message.regions(0).vertices(), 7u);
  EXPECT_FALSE(message.has_symmetry_index_mm());
  EXPECT_EQ(to_deficit(deficit, false).distance_mm_size(), 0);
}

}  // namespace
}  // namespace lipofill::server
