#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cpp/volume/tissue_labels.h"
#include "client/cpp/volume/volume_reader.h"

namespace lipofill::client {

/// The nodes of a charted skin, row by row, xi running fastest.
struct SkinNodes {
  int n_xi = 0;  ///< nodes along xi
  int n_eta = 0;
  Eigen::Matrix3Xd points_mm;  ///< in the axes of the volume
  Eigen::Matrix3Xd inward;     ///< unit normals into the face
};

/// Why nothing was measured at a node.
enum class Unmeasured : uint8_t {
  kMeasured = 0,
  kScanEnds = 1,  ///< the volume ends before what was looked for
  kMetal = 2,     ///< metal shines nearer than ThicknessMeasuring::metal_reach_mm
  kNotMet = 3,    ///< what was looked for does not lie within kDeepestMm
};

/// What to look for in a volume of values, and when not to believe it.
struct ThicknessMeasuring {
  double bone_from = 250.0;      ///< values from here on are bone; in a CT [HU]
  double metal_from = 3000.0;    ///< values from here on are metal
  double metal_reach_mm = 10.0;  ///< metal spoils what lies nearer
};

/// The place under each node where tissue of one kind ends.
struct Boundary {
  Eigen::VectorXd depth_mm;  ///< along the inward normal from where the tissue begins; NaN: not measured
  std::vector<Unmeasured> why;
};

/// Deeper than this nothing is looked for [mm].
inline constexpr double kDeepestMm = 60.0;

/// Looks along the inward normals of a skin into a volume.
///
/// In a label map tissue begins where the first voxel with a tissue lies, within 5 mm of the node
/// on both sides, and a tissue ends where the first voxel of a deeper one lies. A place is within a
/// tissue where a trilinear mean of voxels, 1 in the tissue and 0 elsewhere, is one half. Where the
/// map does not know the next deeper tissue at all, voxels without a tissue end it too. In a volume
/// of values tissue begins at the node, and ends at bone, where the trilinear mean of the values
/// reaches bone_from. Accurate to about a quarter of a voxel on even boundaries; steps of a label
/// map are smoothed away over the neighbours of each node, of those that are measured. Checked by
/// tests/unit/client/tissue_thickness_test.cc.
class ThicknessProbe {
 public:
  /// INVALID_ARGUMENT for slices that are not spaced evenly.
  /// @param labels  of a label map; empty: a volume of values
  /// @param metal   places of metal [mm], from find_metal()
  /// @pre the volume outlives the probe
  static absl::StatusOr<ThicknessProbe> make(const std::filesystem::path& source, const Volume& volume,
                                             const TissueLabels& labels, const ThicknessMeasuring& measuring,
                                             const Eigen::Matrix3Xd& metal);

  bool knows(Tissue tissue) const;
  /// Finds where `tissue` ends and something deeper begins; kMuscle ends on bone.
  Boundary find_end(const SkinNodes& skin, Tissue tissue) const;

 private:
  /// What is looked for: a number of each voxel, and the level from which on it is found.
  struct Sought {
    std::function<double(double)> number_of;
    double level = 0.5;
  };
  /// A place along a ray.
  struct Found {
    double depth_mm = 0.0;
    Unmeasured why = Unmeasured::kNotMet;
  };

  ThicknessProbe() = default;
  Sought tissue_at_all() const;
  Sought deeper_than(Tissue tissue) const;
  std::optional<double> mean_at(const Eigen::Vector3d& mm, const Sought& sought) const;
  Found find_begin(const Eigen::Vector3d& node, const Eigen::Vector3d& inward) const;
  Found look(const Eigen::Vector3d& node, const Eigen::Vector3d& inward, double from_mm, double to_mm,
             const Sought& sought) const;
  bool is_near_metal(const Eigen::Vector3d& node, const Eigen::Vector3d& inward, double depth_mm) const;

  const Volume* volume_ = nullptr;
  TissueLabels labels_;
  ThicknessMeasuring measuring_;
  Eigen::Matrix3Xd metal_;
  Eigen::Matrix4d mm_to_index_ = Eigen::Matrix4d::Identity();
  double step_mm_ = 0.5;
};

/// The middles of voxels that are metal: of the label, or from metal_from on [mm]. At most about
/// 20,000, evenly picked.
Eigen::Matrix3Xd find_metal(const Volume& volume, const TissueLabels& labels, const ThicknessMeasuring& measuring);

}  // namespace lipofill::client
