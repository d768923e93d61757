#include "client/cpp/volume/skin_extraction.h"

#include <vtkCleanPolyData.h>
#include <vtkFlyingEdges3D.h>
#include <vtkMatrix4x4.h>
#include <vtkMatrixToLinearTransform.h>
#include <vtkNew.h>
#include <vtkOBJWriter.h>
#include <vtkPLYWriter.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataConnectivityFilter.h>
#include <vtkQuadricDecimation.h>
#include <vtkReverseSense.h>
#include <vtkSTLWriter.h>
#include <vtkTransformPolyDataFilter.h>
#include <vtkWindowedSincPolyDataFilter.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/io/vtk_messages.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/label_mask.h"
#include "client/cpp/volume/tissue_labels.h"
#include "client/cpp/volume/value_range.h"

namespace lipofill::client {
namespace {

using Surface = vtkSmartPointer<vtkPolyData>;

/// Half way between what is in a mask and what is not.
constexpr double kMaskIsovalue = 0.5;

template <typename Filter>
Surface output_of(Filter* filter, vtkPolyData* input) {
  filter->SetInputData(input);
  filter->Update();
  return filter->GetOutput();
}

/// The value in the voxels' own numbers. Between whole numbers where the voxels are whole: a corner
/// on a voxel would be the corner of triangles without area, which nothing after this can mend.
double voxel_value(const Volume& volume, double isovalue) {
  const double value = (isovalue - volume.intercept) / volume.slope;
  const int type = volume.voxels->GetScalarType();
  const bool whole = type != VTK_FLOAT && type != VTK_DOUBLE;
  return whole && value == std::floor(value) ? value + 0.5 : value;
}

Surface contour(const Volume& volume, double isovalue) {
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(volume.voxels);
  contour->SetValue(0, voxel_value(volume, isovalue));
  contour->ComputeNormalsOff();
  contour->ComputeScalarsOff();
  contour->Update();
  return contour->GetOutput();
}

/// Converts voxel indices to millimetres where slices lie unevenly: p = o(k) + i a + j b, with the
/// origin o of a slice linear between slices.
Surface map_slices(const Volume& volume, vtkPolyData* surface) {
  const auto& origins = volume.slice_origins;
  const Affine& m = volume.index_to_mm;
  vtkPoints* points = surface->GetPoints();
  for (vtkIdType n = 0; n < points->GetNumberOfPoints(); ++n) {
    std::array<double, 3> at{}, mapped{};
    points->GetPoint(n, at.data());
    const auto below = std::min(static_cast<size_t>(std::max(at[2], 0.0)), origins.size() - 2);
    const double part = at[2] - static_cast<double>(below);
    for (size_t row = 0; row < 3; ++row) {
      const double origin = origins[below][row] + part * (origins[below + 1][row] - origins[below][row]);
      mapped[row] = origin + at[0] * m[4 * row] + at[1] * m[4 * row + 1];
    }
    points->SetPoint(n, mapped.data());
  }
  return surface;
}

/// Converts voxel indices to millimetres; triangles face the lower values also when the axes
/// are left-handed or the slope is negative.
Surface to_millimetres(const Volume& volume, vtkPolyData* surface) {
  vtkNew<vtkMatrix4x4> matrix;
  matrix->DeepCopy(volume.index_to_mm.data());
  vtkNew<vtkMatrixToLinearTransform> transform;
  transform->SetInput(matrix);
  vtkNew<vtkTransformPolyDataFilter> mapped;
  mapped->SetTransform(transform);
  Surface result = volume.slice_origins.empty() ? output_of(mapped.Get(), surface) : map_slices(volume, surface);
  if (matrix->Determinant() * volume.slope > 0) return result;
  vtkNew<vtkReverseSense> reversed;
  reversed->ReverseCellsOn();
  reversed->ReverseNormalsOff();
  return output_of(reversed.Get(), result);
}

Surface extract_largest(vtkPolyData* surface, bool take_all, int* components) {
  vtkNew<vtkPolyDataConnectivityFilter> connectivity;
  if (take_all) {
    connectivity->SetExtractionModeToAllRegions();
  } else {
    connectivity->SetExtractionModeToLargestRegion();
  }
  Surface extracted = output_of(connectivity.Get(), surface);
  *components = connectivity->GetNumberOfExtractedRegions();
  // The filter leaves the points of the other pieces behind.
  vtkNew<vtkCleanPolyData> clean;
  clean->PointMergingOff();
  Surface result = output_of(clean.Get(), extracted);
  result->GetPointData()->Initialize();
  return result;
}

Surface smooth(vtkPolyData* surface, int iterations) {
  vtkNew<vtkWindowedSincPolyDataFilter> filter;
  filter->SetNumberOfIterations(iterations);
  filter->SetPassBand(0.1);
  filter->NormalizeCoordinatesOn();
  filter->BoundarySmoothingOff();
  filter->FeatureEdgeSmoothingOff();
  return output_of(filter.Get(), surface);
}

Surface decimate(vtkPolyData* surface, uint64_t target) {
  const auto count = static_cast<double>(surface->GetNumberOfCells());
  if (static_cast<double>(target) >= count) return surface;
  vtkNew<vtkQuadricDecimation> filter;
  filter->SetTargetReduction(1.0 - static_cast<double>(target) / count);
  return output_of(filter.Get(), surface);
}

absl::Status write_surface(const std::filesystem::path& out, vtkPolyData* surface) {
  const VtkMessages messages;
  const std::string extension = absl::AsciiStrToLower(out.extension().string());
  const auto write = [&](auto* writer) {
    writer->SetFileName(out.c_str());
    writer->SetInputData(surface);
    writer->Write();
  };
  if (extension == ".obj") {
    write(vtkNew<vtkOBJWriter>().Get());
  } else if (extension == ".ply") {
    write(vtkNew<vtkPLYWriter>().Get());
  } else {
    vtkNew<vtkSTLWriter> writer;
    writer->SetFileTypeToBinary();
    write(writer.Get());
  }
  if (messages.error().empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("cannot write ", out.string(), ": ", messages.error()));
}

}  // namespace

absl::Status check_surface_name(const std::filesystem::path& out) {
  const std::string extension = absl::AsciiStrToLower(out.extension().string());
  if (extension == ".obj" || extension == ".ply" || extension == ".stl") return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("output ", out.string(), ": '", extension, "' is not one of .obj, .ply, .stl"));
}

absl::StatusOr<ExtractedSkin> extract_skin(Volume volume, const std::filesystem::path& source,
                                           const std::filesystem::path& out, const SkinExtraction& options) {
  if (auto status = check_surface_name(out); !status.ok()) return status;
  const bool by_label = !options.labels.empty();
  if (by_label) {
    const auto labels = choose_labels(source, volume.label_names, options.labels);
    if (!labels.ok()) return labels.status();
    auto mask = mask_labels(source, volume, *labels);
    if (!mask.ok()) return mask.status();
    volume = *std::move(mask);
  }
  ExtractedSkin skin;
  const double isovalue = by_label ? kMaskIsovalue : options.isovalue;
  Surface surface = contour(volume, isovalue);
  if (surface->GetNumberOfCells() == 0) return bad_volume(source, explain_no_surface(volume, isovalue));
  volume.voxels = nullptr;
  surface = extract_largest(to_millimetres(volume, surface), options.all_components, &skin.components);
  if (options.smoothing_iterations > 0) surface = smooth(surface, options.smoothing_iterations);
  if (options.target_triangles > 0) surface = decimate(surface, options.target_triangles);
  if (auto status = write_surface(out, surface); !status.ok()) return status;
  skin.vertices = static_cast<uint64_t>(surface->GetNumberOfPoints());
  skin.triangles = static_cast<uint64_t>(surface->GetNumberOfCells());
  surface->GetBounds(skin.bounds_mm.data());
  skin.frame = volume.frame;
  skin.remarks = volume.remarks;
  return skin;
}

absl::StatusOr<ExtractedSkin> extract_skin(const std::filesystem::path& file, const std::filesystem::path& out,
                                           const SkinExtraction& options) {
  if (auto status = check_surface_name(out); !status.ok()) return status;
  auto volume = read_volume(file);
  if (!volume.ok()) return volume.status();
  return extract_skin(*std::move(volume), file, out, options);
}

}  // namespace lipofill::client
