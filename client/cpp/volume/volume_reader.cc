#include "client/cpp/volume/volume_reader.h"

#include <vtkByteSwap.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <Eigen/Dense>

#include <cmath>
#include <cstring>
#include <limits>

#include "absl/strings/str_cat.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

/// Reads as many voxels as the file has been found to hold. The readers of VTK and ITK are not
/// used: core/doc/decisions/035-volume-readers.md.
absl::StatusOr<vtkSmartPointer<vtkImageData>> take_voxels(const std::filesystem::path& file,
                                                          const VolumeHeader& header) {
  const uint64_t bytes = header.voxel_bytes();
  const auto values = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(header.vtk_type));
  values->SetNumberOfTuples(static_cast<vtkIdType>(header.voxel_count()));
  char* voxels = static_cast<char*>(values->GetVoidPointer(0));
  uint64_t read = 0;
  const auto status =
      unpack_voxels(header.voxels, bytes / header.voxels.files.size(), [&](const unsigned char* piece, size_t size) {
        std::memcpy(voxels + read, piece, size);
        read += size;
        return true;
      });
  if (!status.ok()) return bad_volume(file, status.message());
  if (read < bytes) return bad_volume(file, "cannot be read to its end");
  if (header.big_endian && header.bytes_per_voxel > 1) {
    vtkByteSwap::SwapVoidRange(voxels, static_cast<size_t>(values->GetNumberOfTuples()),
                               static_cast<size_t>(header.bytes_per_voxel));
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(static_cast<int>(header.size[0]), static_cast<int>(header.size[1]),
                       static_cast<int>(header.size[2]));
  image->GetPointData()->SetScalars(values);
  return image;
}

/// Puts air, or what is lower, where a voxel is no number, and the highest value there is for an
/// infinite one.
template <typename T>
absl::Status fill_with_air(const std::filesystem::path& file, vtkDataArray* values, Volume* volume) {
  T* const voxels = static_cast<T*>(values->GetVoidPointer(0));
  const vtkIdType count = values->GetNumberOfTuples();
  T least = std::numeric_limits<T>::max(), most = std::numeric_limits<T>::lowest();
  vtkIdType wrong = 0;
  for (vtkIdType k = 0; k < count; ++k) {
    if (!std::isfinite(voxels[k])) {
      ++wrong;
      continue;
    }
    least = std::min(least, voxels[k]);
    most = std::max(most, voxels[k]);
  }
  if (wrong == 0) return absl::OkStatus();
  if (wrong == count) return bad_volume(file, "has no voxel that is a finite number");
  const double air = (kAirHu - volume->intercept) / volume->slope;
  // A negative slope has air above everything.
  const T nothing = static_cast<T>(volume->slope > 0 ? std::min<double>(air, least) : std::max<double>(air, most));
  const T everything = volume->slope > 0 ? most : least;
  for (vtkIdType k = 0; k < count; ++k) {
    if (std::isfinite(voxels[k])) continue;
    const bool is_high = std::isinf(voxels[k]) && (voxels[k] > 0) == (volume->slope > 0);
    voxels[k] = is_high ? everything : nothing;
  }
  volume->remarks.push_back(absl::StrCat(wrong, " of ", count, " voxels are not finite numbers: they are taken for air",
                                         ", infinite ones for the highest value"));
  return absl::OkStatus();
}

bool spans_space(const Affine& map) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(map.data());
  const Eigen::Matrix3d axes = matrix.topLeftCorner<3, 3>();
  const double box = axes.colwise().norm().prod();
  return box > 0.0 && std::abs(axes.determinant()) > 1e-6 * box;
}

}  // namespace

absl::StatusOr<Volume> read_volume(const std::filesystem::path& file) {
  auto header = read_volume_header(file);
  if (!header.ok()) return header.status();
  if (!spans_space(header->index_to_mm)) return bad_volume(file, "has axes that do not span space, or a spacing of 0");
  auto voxels = take_voxels(file, *header);
  if (!voxels.ok()) return voxels.status();
  Volume volume;
  volume.voxels = *voxels;
  volume.index_to_mm = header->index_to_mm;
  volume.slope = header->slope;
  volume.intercept = header->intercept;
  volume.frame = header->frame;
  volume.label_names = header->label_names;
  volume.remarks = header->remarks;
  vtkDataArray* values = volume.voxels->GetPointData()->GetScalars();
  absl::Status status;
  if (header->vtk_type == VTK_FLOAT) status = fill_with_air<float>(file, values, &volume);
  if (header->vtk_type == VTK_DOUBLE) status = fill_with_air<double>(file, values, &volume);
  if (!status.ok()) return status;
  return volume;
}

}  // namespace lipofill::client
