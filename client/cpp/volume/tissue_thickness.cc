#include "client/cpp/volume/tissue_thickness.h"

#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

using Eigen::Vector3d;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// The skin of a model may lie so far from that of the labels: it was smoothed, and thinned out.
constexpr double kSkinOff = 5.0;
/// How closely metal is looked for along a ray [mm].
constexpr double kMetalStep = 3.0;
constexpr vtkIdType kMostMetal = 20'000;
constexpr int kSmoothings = 2;
/// A node on the outermost voxels is still within the volume [voxels].
constexpr double kOutside = 1e-6;

double value_of(const Volume& volume, vtkDataArray* voxels, vtkIdType at) {
  return volume.slope * voxels->GetComponent(at, 0) + volume.intercept;
}

std::optional<Tissue> tissue_of(const TissueLabels& labels, double value) {
  const auto found = labels.find(std::llround(value));
  return found == labels.end() ? std::nullopt : std::optional(found->second);
}

/// Metal in place of bone, as a tooth's crown is, lies as deep as bone.
int order_of(Tissue tissue) {
  return std::min(static_cast<int>(tissue), static_cast<int>(Tissue::kBone));
}

/// The mean of each value that is known and its neighbours along one direction that are, weighted
/// 1 2 1.
Eigen::VectorXd smoothed(const SkinNodes& skin, const Eigen::VectorXd& values, int step_i, int step_j) {
  Eigen::VectorXd result = values;
  const auto at = [&](int i, int j) {
    const bool exists = i >= 0 && j >= 0 && i < skin.n_xi && j < skin.n_eta;
    return exists ? values[j * skin.n_xi + i] : kNone;
  };
  for (int j = 0; j < skin.n_eta; ++j) {
    for (int i = 0; i < skin.n_xi; ++i) {
      const double middle = at(i, j), before = at(i - step_i, j - step_j), after = at(i + step_i, j + step_j);
      // One neighbour alone would draw the value to its side.
      if (std::isfinite(middle) && std::isfinite(before) && std::isfinite(after))
        result[j * skin.n_xi + i] = 0.5 * middle + 0.25 * (before + after);
    }
  }
  return result;
}

}  // namespace

absl::StatusOr<ThicknessProbe> ThicknessProbe::make(const std::filesystem::path& source, const Volume& volume,
                                                    const TissueLabels& labels, const ThicknessMeasuring& measuring,
                                                    const Eigen::Matrix3Xd& metal) {
  if (!volume.slice_origins.empty())
    return bad_volume(source, "has slices that are not spaced evenly, in which depths are not measured: resample it");
  ThicknessProbe probe;
  probe.volume_ = &volume;
  probe.labels_ = labels;
  probe.measuring_ = measuring;
  probe.metal_ = metal;
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> map(volume.index_to_mm.data());
  probe.mm_to_index_ = map.inverse();
  probe.step_mm_ = 0.5 * map.topLeftCorner<3, 3>().colwise().norm().minCoeff();
  return probe;
}

bool ThicknessProbe::knows(Tissue tissue) const {
  if (labels_.empty()) return tissue == Tissue::kBone;
  return std::any_of(labels_.begin(), labels_.end(), [&](const auto& label) { return label.second == tissue; });
}

ThicknessProbe::Sought ThicknessProbe::tissue_at_all() const {
  return {[this](double value) { return tissue_of(labels_, value) ? 1.0 : 0.0; }, 0.5};
}

ThicknessProbe::Sought ThicknessProbe::deeper_than(Tissue tissue) const {
  if (labels_.empty()) return {[](double value) { return value; }, measuring_.bone_from};
  const int order = order_of(tissue);
  const bool next_is_known = knows(static_cast<Tissue>(order + 1));
  return {[this, order, next_is_known](double value) {
            const auto found = tissue_of(labels_, value);
            if (!found) return next_is_known ? 0.0 : 1.0;
            return order_of(*found) > order ? 1.0 : 0.0;
          },
          0.5};
}

std::optional<double> ThicknessProbe::mean_at(const Vector3d& mm, const Sought& sought) const {
  const Vector3d index = (mm_to_index_ * mm.homogeneous()).head<3>();
  std::array<int, 3> size{};
  volume_->voxels->GetDimensions(size.data());
  std::array<vtkIdType, 3> low{};
  Vector3d part;
  for (int a = 0; a < 3; ++a) {
    const double most = size[static_cast<size_t>(a)] - 1;
    if (!(index[a] >= -kOutside && index[a] <= most + kOutside)) return std::nullopt;
    const double kept = std::clamp(index[a], 0.0, most);
    low[static_cast<size_t>(a)] = std::min(static_cast<vtkIdType>(kept), static_cast<vtkIdType>(most) - 1);
    part[a] = kept - static_cast<double>(low[static_cast<size_t>(a)]);
  }
  vtkDataArray* const voxels = volume_->voxels->GetPointData()->GetScalars();
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::array<vtkIdType, 3> at = low;
    for (int a = 0; a < 3; ++a) {
      const bool upper = (corner >> a & 1) != 0;
      weight *= upper ? part[a] : 1.0 - part[a];
      at[static_cast<size_t>(a)] += upper ? 1 : 0;
    }
    if (weight == 0.0) continue;
    const vtkIdType id = at[0] + size[0] * (at[1] + static_cast<vtkIdType>(size[1]) * at[2]);
    sum += weight * sought.number_of(value_of(*volume_, voxels, id));
  }
  return sum;
}

ThicknessProbe::Found ThicknessProbe::look(const Vector3d& node, const Vector3d& inward, double from_mm, double to_mm,
                                           const Sought& sought) const {
  const double step = to_mm > from_mm ? step_mm_ : -step_mm_;
  std::optional<double> last;
  for (int k = 0; std::abs(k * step) <= std::abs(to_mm - from_mm); ++k) {
    const double depth = from_mm + k * step;
    const auto mean = mean_at(node + depth * inward, sought);
    if (!mean) return {kNone, Unmeasured::kScanEnds};
    if (*mean >= sought.level) {
      const double back = last ? (*mean - sought.level) / (*mean - *last) : 0.0;
      return {depth - back * step, Unmeasured::kMeasured};
    }
    last = mean;
  }
  return {kNone, Unmeasured::kNotMet};
}

ThicknessProbe::Found ThicknessProbe::find_begin(const Vector3d& node, const Vector3d& inward) const {
  const Sought tissue = tissue_at_all();
  const auto here = mean_at(node, tissue);
  if (!here) return {kNone, Unmeasured::kScanEnds};
  if (*here < tissue.level) return look(node, inward, 0.0, kSkinOff, tissue);
  // From within the tissue its skin is the first place outwards without tissue.
  const Sought none{[tissue](double value) { return 1.0 - tissue.number_of(value); }, 1.0 - tissue.level};
  const Found out = look(node, inward, 0.0, -kSkinOff, none);
  // A scan that ends at the skin has it there.
  return out.why == Unmeasured::kMeasured ? out : Found{0.0, Unmeasured::kMeasured};
}

bool ThicknessProbe::is_near_metal(const Vector3d& node, const Vector3d& inward, double depth_mm) const {
  if (metal_.cols() == 0) return false;
  const double reach = measuring_.metal_reach_mm;
  const Vector3d end = node + depth_mm * inward;
  const Vector3d least = node.cwiseMin(end).array() - reach, most = node.cwiseMax(end).array() + reach;
  if ((metal_.rowwise().maxCoeff().array() < least.array()).any() ||
      (metal_.rowwise().minCoeff().array() > most.array()).any())
    return false;
  for (double depth = 0.0; depth <= depth_mm; depth += kMetalStep) {
    if ((metal_.colwise() - (node + depth * inward)).colwise().squaredNorm().minCoeff() < reach * reach) return true;
  }
  return false;
}

Boundary ThicknessProbe::find_end(const SkinNodes& skin, Tissue tissue) const {
  const Sought sought = deeper_than(tissue);
  const Eigen::Index count = skin.points_mm.cols();
  // Where voxels without a tissue end a layer, those of the air in front of it must not.
  const bool next_is_known = labels_.empty() || knows(static_cast<Tissue>(order_of(tissue) + 1));
  const double past_air = next_is_known ? 0.0 : 2.0 * step_mm_;
  Boundary boundary{Eigen::VectorXd::Constant(count, kNone), {}};
  boundary.why.assign(static_cast<size_t>(count), Unmeasured::kNotMet);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Vector3d node = skin.points_mm.col(k), inward = skin.inward.col(k);
    const Found begin = labels_.empty() ? Found{0.0, Unmeasured::kMeasured} : find_begin(node, inward);
    Found end = begin;
    if (begin.why == Unmeasured::kMeasured) end = look(node, inward, begin.depth_mm + past_air, kDeepestMm, sought);
    const double looked = end.why == Unmeasured::kMeasured ? end.depth_mm : 0.5 * kDeepestMm;
    if (is_near_metal(node, inward, std::max(0.0, looked))) end = {kNone, Unmeasured::kMetal};
    boundary.why[static_cast<size_t>(k)] = end.why;
    if (end.why == Unmeasured::kMeasured) boundary.depth_mm[k] = end.depth_mm - begin.depth_mm;
  }
  for (int pass = 0; pass < (labels_.empty() ? 0 : kSmoothings); ++pass) {
    boundary.depth_mm = smoothed(skin, boundary.depth_mm, 1, 0);
    boundary.depth_mm = smoothed(skin, boundary.depth_mm, 0, 1);
  }
  return boundary;
}

Eigen::Matrix3Xd find_metal(const Volume& volume, const TissueLabels& labels, const ThicknessMeasuring& measuring) {
  vtkDataArray* const voxels = volume.voxels->GetPointData()->GetScalars();
  const auto is_metal = [&](double value) {
    return labels.empty() ? value >= measuring.metal_from : tissue_of(labels, value) == Tissue::kMetal;
  };
  std::vector<vtkIdType> found;
  for (vtkIdType k = 0; k < voxels->GetNumberOfTuples(); ++k) {
    if (is_metal(value_of(volume, voxels, k))) found.push_back(k);
  }
  const vtkIdType stride = static_cast<vtkIdType>(found.size()) / kMostMetal + 1;
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> map(volume.index_to_mm.data());
  Eigen::Matrix3Xd metal(3, (static_cast<vtkIdType>(found.size()) + stride - 1) / stride);
  for (Eigen::Index k = 0; k < metal.cols(); ++k) {
    std::array<double, 3> index{};
    volume.voxels->GetPoint(found[static_cast<size_t>(k * stride)], index.data());
    metal.col(k) = (map * Eigen::Vector4d(index[0], index[1], index[2], 1.0)).head<3>();
  }
  return metal;
}

}  // namespace lipofill::client
