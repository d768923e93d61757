#include "client/cpp/dicom/dicom_volume.h"

#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "client/cpp/dicom/dicom_choice.h"
#include "client/cpp/dicom/dicom_pixels.h"
#include "client/cpp/volume/header_text.h"

namespace lipofill::client {
namespace {

/// The plan says what the voxels of a series are kept as.
struct VoxelPlan {
  int vtk_type = VTK_FLOAT;
  bool rescaled = false;  ///< slices have rescales of their own, which are applied at once
};

bool has_one_rescale(const std::vector<DicomFrame>& slices) {
  return std::all_of(slices.begin(), slices.end(), [&](const DicomFrame& slice) {
    return slice.slope == slices.front().slope && slice.intercept == slices.front().intercept;
  });
}

/// The smallest type that holds the pixels of the first slice, of whose format all must be.
VoxelPlan plan_voxels(const PixelFormat& format, bool one_rescale) {
  if (!one_rescale) return {VTK_FLOAT, true};
  const int bits = format.bits_stored + (format.is_signed ? 0 : 1);
  if (bits <= 16) return {VTK_SHORT, false};
  if (format.bits_stored <= 16) return {VTK_UNSIGNED_SHORT, false};
  return {bits <= 32 ? VTK_INT : VTK_DOUBLE, false};
}

/// Writes the pixels of a slice to its voxels.
template <typename T>
void put_slice(const DicomFrame& slice, const PixelFormat& format, bool rescaled, const std::vector<int32_t>& pixels,
               T* voxels) {
  const double air = (kAirHu - slice.intercept) / slice.slope;
  for (size_t k = 0; k < pixels.size(); ++k) {
    const bool shows_nothing =
        format.has_padding && pixels[k] >= format.padding_least && pixels[k] <= format.padding_most;
    // Unsigned pixels of all 32 bits do not fit the int32 they come in.
    const bool is_wide = format.bits_stored == 32 && !format.is_signed;
    double value = is_wide ? static_cast<double>(static_cast<uint32_t>(pixels[k])) : static_cast<double>(pixels[k]);
    if (shows_nothing) {
      constexpr auto kLeast = static_cast<double>(std::numeric_limits<T>::lowest());
      constexpr auto kMost = static_cast<double>(std::numeric_limits<T>::max());
      // What is darker than air already stays.
      value = slice.slope > 0 ? std::min(value, air) : std::max(value, air);
      value = std::clamp(value, kLeast, kMost);
    }
    voxels[k] = static_cast<T>(rescaled ? slice.slope * value + slice.intercept : value);
  }
}

/// The frames of a file one behind the other, as compressed ones are found.
std::vector<size_t> order_of_reading(const std::vector<DicomFrame>& slices) {
  std::vector<size_t> order(slices.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&slices](size_t a, size_t b) {
    return std::tie(slices[a].file, slices[a].number) < std::tie(slices[b].file, slices[b].number);
  });
  return order;
}

absl::Status put_slices(const DicomStack& stack, const VoxelPlan& plan, vtkDataArray* values) {
  DicomPixels reader;
  std::vector<int32_t> pixels;
  const size_t slice_size = size_t{stack.slices.front().rows} * stack.slices.front().columns;
  for (const size_t k : order_of_reading(stack.slices)) {
    const DicomFrame& slice = stack.slices[k];
    const auto named = [&slice](const absl::Status& status) {
      return absl::InvalidArgumentError(
          absl::StrCat("its image ", slice.file.filename().string(), " ", status.message()));
    };
    const auto format = reader.format_of(slice);
    if (!format.ok()) return named(format.status());
    const VoxelPlan own = plan_voxels(*format, !plan.rescaled);
    if (own.vtk_type != plan.vtk_type)
      return named(absl::InvalidArgumentError("has another kind of pixels than the first: export those of one kind"));
    if (auto status = reader.read(slice, &pixels); !status.ok()) return named(status);
    void* const to = values->GetVoidPointer(static_cast<vtkIdType>(k * slice_size));
    switch (plan.vtk_type) {
      vtkTemplateMacro(put_slice(slice, *format, plan.rescaled, pixels, static_cast<VTK_TT*>(to)));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Volume> read_stack(const DicomSeries& series) {
  const DicomStack& stack = series.stack;
  const DicomFrame& first = stack.slices.front();
  DicomPixels reader;
  const auto format = reader.format_of(first);
  if (!format.ok()) return format.status();
  const VoxelPlan plan = plan_voxels(*format, has_one_rescale(stack.slices));
  const auto values = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(plan.vtk_type));
  const uint64_t bytes = series.voxels() * static_cast<uint64_t>(values->GetDataTypeSize());
  if (bytes > kMaxVolumeBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("it has ", bytes, " bytes of voxels, more than the ", kMaxVolumeBytes, " allowed"));
  }
  values->SetNumberOfTuples(static_cast<vtkIdType>(series.voxels()));
  if (auto status = put_slices(stack, plan, values); !status.ok()) return status;
  Volume volume;
  volume.voxels = vtkSmartPointer<vtkImageData>::New();
  volume.voxels->SetDimensions(static_cast<int>(first.columns), static_cast<int>(first.rows),
                               static_cast<int>(stack.slices.size()));
  volume.voxels->GetPointData()->SetScalars(values);
  volume.index_to_mm = stack.index_to_mm;
  volume.slice_origins = stack.slice_origins;
  if (!plan.rescaled) {
    volume.slope = first.slope;
    volume.intercept = first.intercept;
  }
  volume.frame = "LPS";
  volume.remarks = stack.remarks;
  if (series.modality == "CT" && !first.has_rescale)
    volume.remarks.push_back("the headers have no rescale to HU: stored values are taken as they are");
  return volume;
}

}  // namespace

absl::StatusOr<DicomListing> list_dicom(const std::filesystem::path& path) {
  const auto source = DicomSource::open(path);
  if (!source.ok()) return source.status();
  return list_series(*source, false);
}

absl::StatusOr<DicomVolume> read_dicom_volume(const std::filesystem::path& path, const DicomReading& options) {
  const auto source = DicomSource::open(path);
  if (!source.ok()) return source.status();
  const auto series = choose_series(path, list_series(*source, options.bridge_gaps), options.series);
  if (!series.ok()) return series.status();
  auto volume = read_stack(*series);
  if (!volume.ok())
    return bad_volume(
        path, absl::StrCat("has a series ", series->label(), " that cannot be read: ", volume.status().message()));
  DicomVolume result;
  result.volume = *std::move(volume);
  result.series_number = series->number;
  result.modality = series->modality;
  const DicomFrame& first = series->stack.slices.front();
  result.size = {first.columns, first.rows, series->stack.slices.size()};
  result.spacing_mm = {first.spacing[0], first.spacing[1], series->stack.slice_spacing};
  return result;
}

}  // namespace lipofill::client
