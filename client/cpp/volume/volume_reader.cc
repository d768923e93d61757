#include "client/cpp/volume/volume_reader.h"

#include <vtkByteSwap.h>
#include <vtkDataArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNIFTIImageHeader.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "client/cpp/io/vtk_messages.h"
#include "client/cpp/volume/header_text.h"
#include "client/cpp/volume/inflated_file.h"

namespace lipofill::client {
namespace {

/// Reads voxels of MetaImage and NRRD, one value a voxel, as many as the file has been found to
/// hold. VTK's readers are not used, as they have their own ideas of a header: on damaged ones that
/// of NRRD does not come to an end, or writes beyond its memory, and that of MetaImage loses some.
absl::Status take_voxels(const std::filesystem::path& file, Volume* volume) {
  const VolumeHeader& header = volume->header;
  const uint64_t bytes = header.voxel_bytes();
  const auto values = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(header.vtk_type));
  values->SetNumberOfTuples(static_cast<vtkIdType>(bytes / header.bytes_per_voxel));
  char* voxels = static_cast<char*>(values->GetVoidPointer(0));
  uint64_t read = 0;
  if (header.compressed) {
    inflate_file(header.data_file, header.data_offset, [&](const unsigned char* piece, size_t size) {
      const auto taken = std::min<uint64_t>(size, bytes - read);
      std::memcpy(voxels + read, piece, taken);
      return (read += taken) < bytes;
    });
  } else {
    std::ifstream input(header.data_file, std::ios::binary);
    input.seekg(static_cast<std::streamoff>(header.data_offset));
    input.read(voxels, static_cast<std::streamsize>(bytes));
    read = static_cast<uint64_t>(input.gcount());
  }
  if (read < bytes) return bad_volume(file, "cannot be read to its end");
  if (header.big_endian) {
    vtkByteSwap::SwapVoidRange(voxels, static_cast<size_t>(values->GetNumberOfTuples()),
                               static_cast<size_t>(header.bytes_per_voxel));
  }
  volume->voxels = vtkSmartPointer<vtkImageData>::New();
  volume->voxels->SetDimensions(static_cast<int>(header.size[0]), static_cast<int>(header.size[1]),
                                static_cast<int>(header.size[2]));
  volume->voxels->GetPointData()->SetScalars(values);
  return absl::OkStatus();
}

absl::Status take_nifti_voxels(const std::filesystem::path& file, vtkNIFTIImageReader* reader, Volume* volume) {
  const VtkMessages messages;
  reader->SetFileName(file.c_str());
  reader->Update();
  if (!messages.error().empty()) return bad_volume(file, absl::StrCat("cannot be read: ", messages.error()));
  vtkImageData* image = reader->GetOutput();
  int size[3];
  image->GetDimensions(size);
  for (size_t i = 0; i < 3; ++i) {
    if (static_cast<uint64_t>(size[i]) != volume->header.size[i])
      return bad_volume(file, "has voxels of another size than its header");
  }
  if (image->GetNumberOfScalarComponents() != 1) return bad_volume(file, "has more than one value a voxel");
  volume->voxels = vtkSmartPointer<vtkImageData>::New();
  volume->voxels->SetDimensions(size);
  volume->voxels->GetPointData()->SetScalars(image->GetPointData()->GetScalars());
  return absl::OkStatus();
}

/// NIfTI maps voxel centres to RAS millimetres by its sform, else its qform, else by the spacing
/// alone. The reader has put the slices into the order its matrices speak of.
void take_nifti_geometry(vtkNIFTIImageReader* reader, Volume* volume) {
  const vtkNIFTIImageHeader* header = reader->GetNIFTIHeader();
  vtkMatrix4x4* matrix = const_cast<vtkNIFTIImageHeader*>(header)->GetSFormCode() > 0 ? reader->GetSFormMatrix()
                                                                                      : reader->GetQFormMatrix();
  double spacing[3];
  reader->GetOutput()->GetSpacing(spacing);
  const bool oriented = volume->header.frame == "LPS";
  volume->index_to_mm = {};
  volume->index_to_mm[15] = 1.0;
  for (int row = 0; row < 3; ++row) {
    const double to_lps = oriented && row < 2 ? -1.0 : 1.0;
    for (int column = 0; column < 4; ++column) {
      const double unit = column < 3 ? spacing[column] : 1.0;
      const double entry = matrix != nullptr ? matrix->GetElement(row, column) : (row == column ? 1.0 : 0.0);
      volume->index_to_mm[static_cast<size_t>(4 * row + column)] = to_lps * entry * unit;
    }
  }
  if (reader->GetRescaleSlope() != 0.0) {
    volume->slope = reader->GetRescaleSlope();
    volume->intercept = reader->GetRescaleIntercept();
  }
}

double determinant(const Affine& m) {
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
}

}  // namespace

absl::StatusOr<Volume> read_volume(const std::filesystem::path& file) {
  auto header = read_volume_header(file);
  if (!header.ok()) return header.status();
  Volume volume;
  volume.header = *header;
  volume.index_to_mm = header->index_to_mm;
  absl::Status status;
  if (header->format == VolumeFormat::kNifti) {
    vtkNew<vtkNIFTIImageReader> reader;
    status = take_nifti_voxels(file, reader, &volume);
    if (status.ok()) take_nifti_geometry(reader, &volume);
  } else {
    status = take_voxels(file, &volume);
  }
  if (!status.ok()) return status;
  if (!(std::abs(determinant(volume.index_to_mm)) > 1e-9)) return bad_volume(file, "has axes that do not span space");
  return volume;
}

}  // namespace lipofill::client
