#include "core/geometry/landmark_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/geometry/head_size.h"
#include "core/geometry/surface_reader.h"

namespace lipofill::geometry {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The face shipped with the project and its landmarks, with those of the right side mirrored from
/// the left.
class LandmarkChecks : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ifstream surface(LIPOFILL_SAMPLE_FACES "/half_face.obj", std::ios::binary);
    std::stringstream text;
    text << surface.rdbuf();
    scan_ = *read_surface(text.str(), SurfaceFormat::kObj, 1e-3);
    const auto description = nlohmann::json::parse(std::ifstream(LIPOFILL_SAMPLE_FACES "/half_face.landmarks.json"));
    for (const auto& [name, xyz] : description["landmarks"].items()) {
      landmarks_[name] = 1e-3 * Eigen::Vector3d(xyz[0].get<double>(), xyz[1].get<double>(), xyz[2].get<double>());
    }
  }

  absl::Status check() {
    remarks_.clear();
    const auto axes = estimate_head_axes(landmarks_);
    return check_landmarks(landmarks_, axes.ok() ? &*axes : nullptr, scan_, SurfaceLocator(scan_), remarks_);
  }

  void expect_refused(const std::string& cause) {
    const absl::Status status = check();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), HasSubstr(cause));
  }

  SurfaceMesh scan_;
  Landmarks landmarks_;
  std::vector<std::string> remarks_;
};

TEST_F(LandmarkChecks, TheSampleFaceHasNothingUnusual) {
  EXPECT_TRUE(check().ok()) << check();
  EXPECT_THAT(remarks_, IsEmpty());
}

TEST_F(LandmarkChecks, TheSampleFaceIsOfUsualSize) {
  EXPECT_EQ(compute_head_scale(landmarks_), 1.0);
  for (auto& [name, position] : landmarks_) position *= 1.1;
  EXPECT_EQ(compute_head_scale(landmarks_), 1.1);
  landmarks_.erase("zygion_left");
  EXPECT_EQ(compute_head_scale(landmarks_), std::nullopt);
}

TEST_F(LandmarkChecks, SwappedSidesAreNamed) {
  std::swap(landmarks_["cheilion_left"], landmarks_["cheilion_right"]);
  expect_refused("left and right are swapped, or the scan is mirrored");
}

TEST_F(LandmarkChecks, AMirroredScanIsNamed) {
  for (auto& [name, position] : landmarks_) position.x() = -position.x();
  scan_.points.row(0) *= -1.0;
  expect_refused("the scan is mirrored");
}

TEST_F(LandmarkChecks, CentimetresTakenForMillimetresAreNamed) {
  for (auto& [name, position] : landmarks_) position *= 0.1;
  scan_.points *= 0.1;
  expect_refused("centimetres that are taken for millimetres");
  EXPECT_THAT(std::string(check().message()), HasSubstr("0.10 of an adult's"));
}

TEST_F(LandmarkChecks, ASmallHeadIsRemarkedUpon) {
  for (auto& [name, position] : landmarks_) position *= 0.6;
  scan_.points *= 0.6;
  EXPECT_TRUE(check().ok()) << check();
  EXPECT_THAT(remarks_, Contains(HasSubstr("The head is of unusual size")));
}

TEST_F(LandmarkChecks, AScanThatEndsBeforeALandmarkIsRemarkedUpon) {
  // The rear border of the face runs down behind the ear.
  landmarks_["tragion_left"] = Eigen::Vector3d(scan_.points.col(103 * 48 - 1)) + Eigen::Vector3d(-0.004, 0.0, -0.012);
  EXPECT_TRUE(check().ok()) << check();
  EXPECT_THAT(remarks_, Contains(HasSubstr("mm before tragion_left")));
}

TEST_F(LandmarkChecks, ALandmarkOffTheSkinIsRemarkedUponAndThenRefused) {
  const Eigen::Vector3d outward = Eigen::Vector3d(1.0, 0.0, 0.3).normalized();
  landmarks_["gonion_left"] += 0.007 * outward;
  EXPECT_TRUE(check().ok()) << check();
  EXPECT_THAT(remarks_, Contains(HasSubstr("gonion_left lies")));
  landmarks_["gonion_left"] += 0.010 * outward;
  expect_refused("gonion_left");
}

}  // namespace
}  // namespace lipofill::geometry
