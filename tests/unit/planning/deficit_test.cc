#include "core/planning/deficit.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/base/units.h"
#include "core/geometry/surface_reader.h"
#include "nlohmann/json.hpp"
#include "tests/unit/geometry/test_surfaces.h"
#include "tests/unit/planning/test_heads.h"

namespace lipofill::planning {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kShared[] = LIPOFILL_SHARED_DATA;

geometry::SurfaceMesh read_obj(const std::string& name) {
  std::ifstream file(std::string(kShared) + "/" + name, std::ios::binary);
  std::stringstream bytes;
  bytes << file.rdbuf();
  return *geometry::read_surface(bytes.str(), geometry::SurfaceFormat::kObj, kMetresPerMillimetre);
}

geometry::Landmarks read_landmarks(const nlohmann::json& marks) {
  geometry::Landmarks landmarks;
  for (const auto& [name, p] : marks.items()) {
    landmarks[name] = kMetresPerMillimetre * Eigen::Vector3d(p[0], p[1], p[2]);
  }
  return landmarks;
}

const RegionDeficit* find_region(const Deficit& deficit, const std::string& name) {
  for (const RegionDeficit& region : deficit.regions) {
    if (region.region == name) return &region;
  }
  return nullptr;
}

// Between spheres of 50 and 52 mm there are 4/3 pi (52^3 - 50^3) mm3 = 65.38 mL.
TEST(Deficit, BetweenSpheresIsTheShell) {
  const geometry::SurfaceMesh skin = geometry::make_sphere(0.050, 60);
  const geometry::SurfaceMesh target = geometry::make_sphere(0.052, 60);
  const auto deficit = measure_deficit({skin, target, {}, 0.005});
  ASSERT_TRUE(deficit.ok()) << deficit.status();
  EXPECT_NEAR(deficit->all.volume.deficit / 65.38e-6, 1.0, 0.005);
  EXPECT_EQ(deficit->all.volume.excess, 0.0);
  EXPECT_NEAR(deficit->all.max_deficit, 2e-3, 2e-5);
  EXPECT_NEAR(deficit->all.distance.signed_mean, -2e-3, 2e-5);
  EXPECT_NEAR(deficit->hausdorff, 2e-3, 2e-5);
  EXPECT_EQ(deficit->distances.size(), static_cast<size_t>(skin.n_vertices()));
  EXPECT_THAT(deficit->remarks, ElementsAre(HasSubstr("need landmarks")));
}

TEST(Deficit, SaysThatATargetLiesBelowEverywhere) {
  const geometry::SurfaceMesh skin = geometry::make_sphere(0.052, 40);
  const auto deficit = measure_deficit({skin, geometry::make_sphere(0.050, 40), {}, 0.0});
  ASSERT_TRUE(deficit.ok());
  EXPECT_THAT(deficit->remarks, ::testing::Contains(HasSubstr("below the skin nearly everywhere")));
  EXPECT_EQ(deficit->all.max_deficit, 0.0);
}

TEST(Deficit, OfOneCheekIsInItsRegion) {
  std::vector<Bump> bumps = symmetric_bumps();
  const geometry::SurfaceMesh target = make_head(bumps);
  bumps.push_back({{0.75, -0.35, 0.4}, 0.25, -0.005});
  const geometry::SurfaceMesh skin = make_head(bumps);
  const geometry::Landmarks landmarks = make_landmarks(target);
  const auto deficit = measure_deficit({skin, target, landmarks, 0.005});
  ASSERT_TRUE(deficit.ok()) << deficit.status();
  const RegionDeficit* left = find_region(*deficit, "masseter_left");
  const RegionDeficit* right = find_region(*deficit, "masseter_right");
  ASSERT_TRUE(left != nullptr && right != nullptr);
  EXPECT_GT(left->volume.deficit, 0.5 * deficit->all.volume.deficit);
  EXPECT_LT(right->volume.deficit, 1e-9);
  ASSERT_TRUE(deficit->symmetry_index.has_value());
  EXPECT_GT(*deficit->symmetry_index, 2e-4);
}

TEST(Deficit, LeavesOutTheRim) {
  const geometry::SurfaceMesh skin = cut_away(make_even_head(), {0, 0, -1}, 0.5);
  const auto near = measure_deficit({skin, skin, {}, 0.0});
  const auto far = measure_deficit({skin, skin, {}, 0.02});
  ASSERT_TRUE(near.ok() && far.ok());
  EXPECT_LT(far->all.area, 0.95 * near->all.area);
  EXPECT_GT(std::count_if(far->distances.begin(), far->distances.end(), [](double d) { return std::isnan(d); }), 100);
  const auto nothing = measure_deficit({skin, skin, {}, 0.5});
  EXPECT_TRUE(absl::IsFailedPrecondition(nothing.status())) << nothing.status();
}

// The README beside the shared scans states 10.817 mL, from the closed form of the displacement.
TEST(Deficit, OfTheSharedPatientIsTheVolumeThatWasTaken) {
  if (!std::filesystem::exists(std::string(kShared) + "/lps_patient_before.obj")) {
    GTEST_SKIP() << "no patient in " << kShared;
  }
  std::ifstream file(std::string(kShared) + "/lps_patient_target.landmarks.json");
  const geometry::Landmarks landmarks = read_landmarks(nlohmann::json::parse(file)["landmarks"]);
  const geometry::SurfaceMesh before = read_obj("lps_patient_before.obj");
  const auto deficit = measure_deficit({before, read_obj("lps_patient_target.obj"), landmarks, 0.005});
  ASSERT_TRUE(deficit.ok()) << deficit.status();
  EXPECT_NEAR(deficit->all.volume.deficit / 10.817e-6, 1.0, 0.02);
  EXPECT_LT(deficit->all.volume.excess, 0.02e-6);
  const RegionDeficit* masseter = find_region(*deficit, "masseter_left");
  ASSERT_NE(masseter, nullptr);
  EXPECT_GT(masseter->volume.deficit, 4e-6);
  const RegionDeficit* other = find_region(*deficit, "masseter_right");
  ASSERT_NE(other, nullptr);
  EXPECT_EQ(other->volume.deficit, 0.0);
  std::printf("%.3f mL missing, %.4f too much, %.3f in masseter_left\n", deficit->all.volume.deficit * 1e6,
              deficit->all.volume.excess * 1e6, masseter->volume.deficit * 1e6);
}

}  // namespace
}  // namespace lipofill::planning
