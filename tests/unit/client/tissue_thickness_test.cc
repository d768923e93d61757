// Thickness of tissue under a flat and a round skin, in label maps and in volumes of values.

#include "client/cpp/volume/tissue_thickness.h"

#include <gmock/gmock.h>
#include <vtkPointData.h>

#include <cmath>
#include <cstdio>
#include <functional>

namespace lipofill::client {
namespace {

using Eigen::Vector3d;
using ::testing::Each;
using ::testing::HasSubstr;

constexpr double kVoxel = 0.8;
constexpr int kSide = 100;
constexpr double kHead = 36.0;
const Vector3d kCentre(1040.0, -960.0, 1040.0);  // far from the origin, as a scanner's is

/// A cube of voxels about kCentre whose values follow from the place relative to it [mm].
Volume make_volume(const std::function<int16_t(const Vector3d&)>& value_at) {
  Volume volume;
  volume.voxels = vtkSmartPointer<vtkImageData>::New();
  volume.voxels->SetDimensions(kSide, kSide, kSide);
  volume.voxels->AllocateScalars(VTK_SHORT, 1);
  const Vector3d origin = kCentre - Vector3d::Constant(0.5 * kVoxel * (kSide - 1));
  volume.index_to_mm = {kVoxel, 0, 0, origin.x(), 0, kVoxel, 0, origin.y(), 0, 0, kVoxel, origin.z(), 0, 0, 0, 1};
  volume.frame = "LPS";
  auto* voxel = static_cast<int16_t*>(volume.voxels->GetScalarPointer());
  for (int k = 0; k < kSide; ++k) {
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) *voxel++ = value_at(origin + kVoxel * Vector3d(i, j, k) - kCentre);
    }
  }
  return volume;
}

/// 3 mm of skin, 5 mm of fat, 8 mm of muscle, then bone.
int16_t label_of(double depth) {
  return depth < 0.0 ? 0 : depth < 3.0 ? 1 : depth < 8.0 ? 2 : depth < 16.0 ? 3 : 4;
}

const TissueLabels kLabels = {{1, Tissue::kSkin}, {2, Tissue::kFat}, {3, Tissue::kMuscle}, {4, Tissue::kBone}};

/// A cap of the sphere of radius kHead + off about kCentre, around +x.
SkinNodes make_cap(double off = 0.0) {
  SkinNodes skin{21, 21, Eigen::Matrix3Xd(3, 441), Eigen::Matrix3Xd(3, 441)};
  for (int j = 0; j < 21; ++j) {
    for (int i = 0; i < 21; ++i) {
      const double a = 0.05 * (i - 10), b = 0.05 * (j - 10);
      const Vector3d out(std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b));
      skin.points_mm.col(21 * j + i) = kCentre + (kHead + off) * out;
      skin.inward.col(21 * j + i) = -out;
    }
  }
  return skin;
}

Volume make_round_labels() {
  return make_volume([](const Vector3d& at) { return label_of(kHead - at.norm()); });
}

Boundary end_of(const Volume& volume, const TissueLabels& labels, Tissue tissue, const SkinNodes& skin,
                const ThicknessMeasuring& measuring = {}) {
  const auto probe = ThicknessProbe::make("map.nrrd", volume, labels, measuring, find_metal(volume, labels, measuring));
  EXPECT_TRUE(probe.ok()) << probe.status();
  return probe->find_end(skin, tissue);
}

TEST(TissueThickness, EveryLayerOfALabelMapIsMeasured) {
  const Volume volume = make_round_labels();
  for (const auto& [tissue, depth] : {std::pair{Tissue::kSkin, 3.0}, {Tissue::kFat, 8.0}, {Tissue::kMuscle, 16.0}}) {
    // The skin of a model lies somewhat off that of the labels; thickness does not depend on it.
    for (const double off : {0.0, 1.7, -1.7}) {
      const Boundary end = end_of(volume, kLabels, tissue, make_cap(off));
      EXPECT_THAT(end.why, Each(Unmeasured::kMeasured));
      const Eigen::ArrayXd error = end.depth_mm.array() - depth;
      printf("%s at %+.1f mm: mean error %+.3f mm, largest %.3f mm\n", name_of(tissue), off, error.mean(),
             error.abs().maxCoeff());
      EXPECT_LT(std::abs(error.mean()), 0.1);
      EXPECT_LT(error.abs().maxCoeff(), 0.75 * kVoxel);
      EXPECT_LT(std::sqrt(error.square().mean()), 0.3 * kVoxel);
    }
  }
}

TEST(TissueThickness, WhereTheNextTissueHasNoLabelWhatHasNoneEndsALayer) {
  const Volume volume = make_round_labels();
  const TissueLabels skin_and_bone = {{1, Tissue::kSkin}, {4, Tissue::kBone}};
  EXPECT_NEAR(end_of(volume, skin_and_bone, Tissue::kSkin, make_cap()).depth_mm.mean(), 3.0, 0.1);
  EXPECT_NEAR(end_of(volume, skin_and_bone, Tissue::kMuscle, make_cap()).depth_mm.mean(), 16.0, 0.1);
}

TEST(TissueThickness, InACtTheBoneEndsTheTissue) {
  // The values go from 60 to 900 HU over 2 mm about the bone's surface; 250 HU lies 0.548 mm
  // outside of its middle.
  const Volume volume = make_volume([](const Vector3d& at) {
    const double depth = kHead - at.norm();
    const double bone = std::clamp(0.5 + 0.5 * (depth - 16.0), 0.0, 1.0);
    return static_cast<int16_t>(std::lround(depth < 0.0 ? -1000.0 : 60.0 + 840.0 * bone));
  });
  const Boundary end = end_of(volume, {}, Tissue::kMuscle, make_cap());
  EXPECT_THAT(end.why, Each(Unmeasured::kMeasured));
  const Eigen::ArrayXd error = end.depth_mm.array() - (16.0 - 0.548);
  printf("bone in a CT: mean error %+.3f mm, largest %.3f mm\n", error.mean(), error.abs().maxCoeff());
  EXPECT_LT(error.abs().maxCoeff(), 0.1);
}

TEST(TissueThickness, MetalSpoilsWhatIsNear) {
  const Vector3d tooth(kHead - 14.0, 0.0, 0.0);
  const Volume volume = make_volume([&](const Vector3d& at) {
    const double depth = kHead - at.norm();
    if ((at - tooth).norm() < 2.0) return int16_t{3071};
    return static_cast<int16_t>(depth < 0.0 ? -1000 : depth < 16.0 ? 60 : 900);
  });
  ThicknessMeasuring measuring;
  measuring.metal_reach_mm = 6.0;
  const SkinNodes skin = make_cap();
  const Boundary end = end_of(volume, {}, Tissue::kMuscle, skin, measuring);
  int spoilt = 0;
  for (Eigen::Index k = 0; k < end.depth_mm.size(); ++k) {
    const Vector3d from = tooth + kCentre - skin.points_mm.col(k);
    const double away = (from - from.dot(skin.inward.col(k)) * skin.inward.col(k)).norm() - 2.0;
    const bool is_metal = end.why[static_cast<size_t>(k)] == Unmeasured::kMetal;
    EXPECT_EQ(is_metal, std::isnan(end.depth_mm[k]));
    if (away < 5.0) EXPECT_TRUE(is_metal) << away;
    if (away > 7.0) EXPECT_FALSE(is_metal) << away;
    spoilt += is_metal ? 1 : 0;
  }
  EXPECT_GT(spoilt, 20);
  EXPECT_LT(spoilt, 300);
}

TEST(TissueThickness, WhereTheScanEndsNothingIsMade) {
  const Volume volume = make_round_labels();
  // Rays along +x from a plane that cuts the bone only for some leave the volume behind it.
  SkinNodes skin{3, 1, Eigen::Matrix3Xd(3, 3), Eigen::Vector3d(1, 0, 0).replicate(1, 3)};
  skin.points_mm << kCentre.x() + 2.0, kCentre.x() - kHead, kCentre.x() - 200.0,  //
      kCentre.y() + 28.0, kCentre.y(), kCentre.y(),                               //
      kCentre.z() + 21.0, kCentre.z(), kCentre.z();
  const Boundary end = end_of(volume, kLabels, Tissue::kMuscle, skin);
  EXPECT_EQ(end.why[0], Unmeasured::kScanEnds);
  EXPECT_EQ(end.why[1], Unmeasured::kMeasured);
  EXPECT_EQ(end.why[2], Unmeasured::kScanEnds) << "it lies outside";
  EXPECT_TRUE(std::isnan(end.depth_mm[0]));
  EXPECT_NEAR(end.depth_mm[1], 16.0, 0.5 * kVoxel);
}

TEST(TissueThickness, SlicesThatAreNotEvenAreRefused) {
  Volume volume = make_round_labels();
  volume.slice_origins.resize(kSide);
  const auto probe = ThicknessProbe::make("ct", volume, {}, {}, {});
  EXPECT_THAT(std::string(probe.status().message()), HasSubstr("not spaced evenly"));
}

}  // namespace
}  // namespace lipofill::client
