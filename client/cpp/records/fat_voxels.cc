#include "client/cpp/records/fat_voxels.h"

#include <vtkCellArray.h>
#include <vtkCellArrayIterator.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "absl/strings/str_format.h"

namespace lipofill::client {
namespace {

using Eigen::Vector3d;

constexpr double kMm3PerMl = 1000.0;
constexpr double kMostOutside = 0.01;
/// A cell is cut into at most so many parts along each direction.
constexpr int kMostParts = 64;

/// The grid tells where points lie among the voxels of a stack.
class VoxelGrid {
 public:
  explicit VoxelGrid(const DicomStack& stack) : stack_(stack) {
    const DicomFrame& first = stack.slices.front();
    row_ = Vector3d(first.orientation.data());
    column_ = Vector3d(first.orientation.data() + 3);
    normal_ = row_.cross(column_);
    for (const DicomFrame& slice : stack.slices) heights_.push_back(normal_.dot(Vector3d(slice.position.data())));
  }

  /// Half the width of the narrowest voxel.
  double finest() const {
    const DicomFrame& first = stack_.slices.front();
    return 0.5 * std::min({first.spacing[0], first.spacing[1], stack_.slice_spacing});
  }

  /// The slice whose middle is nearest; none beyond half a spacing outside of the outermost ones.
  std::optional<size_t> slice_of(const Vector3d& point) const {
    const double height = normal_.dot(point);
    const auto above =
        static_cast<size_t>(std::lower_bound(heights_.begin(), heights_.end(), height) - heights_.begin());
    size_t nearest = std::min(above, heights_.size() - 1);
    if (nearest > 0 && height - heights_[nearest - 1] < heights_[nearest] - height) --nearest;
    if (std::abs(height - heights_[nearest]) > 0.5 * thickness_of(nearest)) return std::nullopt;
    return nearest;
  }

  /// The pixel of a slice, counted row by row.
  std::optional<size_t> pixel_of(size_t slice, const Vector3d& point) const {
    const DicomFrame& frame = stack_.slices[slice];
    const Vector3d offset = point - Vector3d(frame.position.data());
    const double i = std::floor(row_.dot(offset) / frame.spacing[0] + 0.5);
    const double j = std::floor(column_.dot(offset) / frame.spacing[1] + 0.5);
    if (!(i >= 0 && i < frame.columns && j >= 0 && j < frame.rows)) return std::nullopt;
    return static_cast<size_t>(j) * frame.columns + static_cast<size_t>(i);
  }

  /// [mm3] of a voxel of a slice.
  double voxel_volume(size_t slice) const {
    const DicomFrame& frame = stack_.slices[slice];
    return frame.spacing[0] * frame.spacing[1] * thickness_of(slice);
  }

 private:
  /// [mm] half-way to both neighbours; at an end as much on the far side as on the near one.
  double thickness_of(size_t slice) const {
    const double below = slice > 0 ? heights_[slice] - heights_[slice - 1] : 0.0;
    const double above = slice + 1 < heights_.size() ? heights_[slice + 1] - heights_[slice] : 0.0;
    if (slice == 0) return above;
    return slice + 1 == heights_.size() ? below : 0.5 * (below + above);
  }

  const DicomStack& stack_;
  Vector3d row_, column_, normal_;
  std::vector<double> heights_;  ///< of the slices along the normal
};

/// A quadrilateral with fat on both sides of it.
struct FilmCell {
  std::array<Vector3d, 4> corners;
  double thickness = 0.0;

  Vector3d middle(double a, double b) const {
    return (1 - a) * (1 - b) * corners[0] + a * (1 - b) * corners[1] + a * b * corners[2] + (1 - a) * b * corners[3];
  }
  /// The normal, as long as the area that it stands for.
  Vector3d normal(double a, double b) const {
    const Vector3d along_a = (1 - b) * (corners[1] - corners[0]) + b * (corners[2] - corners[3]);
    const Vector3d along_b = (1 - a) * (corners[3] - corners[0]) + a * (corners[2] - corners[1]);
    return along_a.cross(along_b);
  }
  double longest_side() const {
    double longest = 0.0;
    for (size_t k = 0; k < 4; ++k) longest = std::max(longest, (corners[(k + 1) % 4] - corners[k]).norm());
    return longest;
  }
};

/// Adds up the volume of fat in each voxel.
class FatSum {
 public:
  explicit FatSum(const VoxelGrid& grid) : grid_(grid) {}

  void add(const FilmCell& cell) {
    const int sides = parts_of(cell.longest_side());
    const int layers = parts_of(cell.thickness);
    for (int ka = 0; ka < sides; ++ka) {
      for (int kb = 0; kb < sides; ++kb)
        add_column(cell, (ka + 0.5) / sides, (kb + 0.5) / sides, sides * sides, layers);
    }
  }

  const std::unordered_map<size_t, std::unordered_map<size_t, double>>& mm3() const { return mm3_; }
  double total_mm3() const { return total_; }
  double outside_mm3() const { return outside_; }

 private:
  int parts_of(double length) const {
    return std::clamp(static_cast<int>(std::ceil(length / grid_.finest())), 1, kMostParts);
  }

  void add_column(const FilmCell& cell, double a, double b, int columns, int layers) {
    const Vector3d normal = cell.normal(a, b);
    const double volume = normal.norm() * cell.thickness / columns / layers;
    if (!(volume > 0.0)) return;
    const Vector3d step = normal.normalized() * cell.thickness;
    for (int kc = 0; kc < layers; ++kc) put(cell.middle(a, b) + ((kc + 0.5) / layers - 0.5) * step, volume);
  }

  void put(const Vector3d& point, double volume) {
    total_ += volume;
    const auto slice = grid_.slice_of(point);
    const auto pixel = slice ? grid_.pixel_of(*slice, point) : std::nullopt;
    if (pixel) {
      mm3_[*slice][*pixel] += volume;
    } else {
      outside_ += volume;
    }
  }

  const VoxelGrid& grid_;
  std::unordered_map<size_t, std::unordered_map<size_t, double>> mm3_;  ///< by slice, then by pixel
  double total_ = 0.0, outside_ = 0.0;
};

FatSum sum_up(vtkPolyData* film, const VoxelGrid& grid) {
  FatSum sum(grid);
  vtkDataArray* const thickness = film->GetCellData()->GetArray("thickness_mm");
  const auto cells = vtk::TakeSmartPointer(film->GetPolys()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell()) {
    vtkIdType size = 0;
    const vtkIdType* corners = nullptr;
    cells->GetCurrentCell(size, corners);
    if (size != 4) continue;
    FilmCell cell;
    for (size_t k = 0; k < 4; ++k) film->GetPoint(corners[k], cell.corners[k].data());
    cell.thickness = thickness->GetComponent(cells->GetCurrentCellId(), 0);
    sum.add(cell);
  }
  return sum;
}

}  // namespace

double find_share_outside(vtkPolyData* surface, const DicomStack& stack) {
  const VoxelGrid grid(stack);
  vtkIdType outside = 0;
  for (vtkIdType k = 0; k < surface->GetNumberOfPoints(); ++k) {
    Vector3d point;
    surface->GetPoint(k, point.data());
    const auto slice = grid.slice_of(point);
    if (!slice || !grid.pixel_of(*slice, point)) ++outside;
  }
  return static_cast<double>(outside) / static_cast<double>(std::max<vtkIdType>(surface->GetNumberOfPoints(), 1));
}

absl::StatusOr<FatVoxels> find_fat_voxels(vtkPolyData* film, const DicomStack& stack) {
  const VoxelGrid grid(stack);
  const FatSum sum = sum_up(film, grid);
  if (sum.outside_mm3() > kMostOutside * sum.total_mm3()) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%.3f of %.3f mL of fat lie outside of the series: the plan was not made on the skin of this series, in LPS",
        sum.outside_mm3() / kMm3PerMl, sum.total_mm3() / kMm3PerMl));
  }
  FatVoxels found;
  found.film_ml = sum.total_mm3() / kMm3PerMl;
  found.outside_ml = sum.outside_mm3() / kMm3PerMl;
  const DicomFrame& first = stack.slices.front();
  for (const auto& [slice, pixels] : sum.mm3()) {
    const double voxel = grid.voxel_volume(slice);
    std::vector<uint8_t> labels(size_t{first.rows} * first.columns, 0);
    size_t count = 0;
    for (const auto& [pixel, mm3] : pixels) {
      labels[pixel] = mm3 >= 0.5 * voxel ? 1 : 0;
      count += labels[pixel];
    }
    if (count == 0) continue;
    found.voxels_ml += static_cast<double>(count) * voxel / kMm3PerMl;
    found.slices.emplace(slice, std::move(labels));
  }
  return found;
}

}  // namespace lipofill::client
