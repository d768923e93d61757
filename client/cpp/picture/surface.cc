#include "client/cpp/picture/surface.h"

#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyDataNormals.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/cpp/io/vtp_file.h"

namespace lipofill::client {
namespace {

/// Pictures are drawn in single precision: a surface far from the origin is moved there.
void move_near_origin(vtkPolyData* surface) {
  if (surface->GetPoints()->GetDataType() != VTK_DOUBLE) return;
  double centre[3];
  surface->GetCenter(centre);
  vtkNew<vtkPoints> near;
  near->SetNumberOfPoints(surface->GetNumberOfPoints());
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
    const double* point = surface->GetPoint(i);
    near->SetPoint(i, point[0] - centre[0], point[1] - centre[1], point[2] - centre[2]);
  }
  surface->SetPoints(near);
}

}  // namespace

absl::StatusOr<Surface> read_plain_surface(const std::filesystem::path& file) {
  auto surface = read_vtp(file);
  if (surface.ok()) move_near_origin(*surface);
  return surface;
}

absl::StatusOr<Surface> read_surface(const std::filesystem::path& file, const std::vector<std::string>& fields) {
  auto read = read_plain_surface(file);
  if (!read.ok()) return read.status();
  const Surface& surface = *read;
  vtkDataArray* displacement = surface->GetPointData()->GetArray(kDisplacement);
  if (displacement == nullptr || displacement->GetNumberOfComponents() != 3) {
    return absl::InvalidArgumentError(absl::StrCat(file.string(), " has no point field ", kDisplacement));
  }
  for (const std::string& field : fields) {
    if (surface->GetPointData()->GetArray(field.c_str()) == nullptr) {
      return absl::InvalidArgumentError(absl::StrCat(file.string(), " has no point field ", field));
    }
  }
  return surface;
}

Surface with_normals(vtkPolyData* surface) {
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(surface);
  normals->SplittingOff();
  normals->ConsistencyOff();
  normals->Update();
  return normals->GetOutput();
}

Surface at_rest(vtkPolyData* moved) {
  auto rest = Surface::New();
  rest->DeepCopy(moved);
  vtkDataArray* displacement = moved->GetPointData()->GetArray(kDisplacement);
  for (vtkIdType i = 0; i < moved->GetNumberOfPoints(); ++i) {
    const double* point = moved->GetPoint(i);
    rest->GetPoints()->SetPoint(i, point[0] - displacement->GetComponent(i, 0),
                                point[1] - displacement->GetComponent(i, 1),
                                point[2] - displacement->GetComponent(i, 2));
  }
  return rest;
}

void add_displacement_length(vtkPolyData* surface) {
  vtkDataArray* displacement = surface->GetPointData()->GetArray(kDisplacement);
  vtkNew<vtkFloatArray> length;
  length->SetName(kDisplacementLength);
  length->SetNumberOfTuples(surface->GetNumberOfPoints());
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
    length->SetValue(i,
                     static_cast<float>(std::hypot(displacement->GetComponent(i, 0), displacement->GetComponent(i, 1),
                                                   displacement->GetComponent(i, 2))));
  }
  surface->GetPointData()->AddArray(length);
}

double largest_size(vtkPolyData* surface, const char* field) {
  vtkDataArray* values = surface->GetPointData()->GetArray(field);
  double largest = 0.0;
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) {
    const double value = std::abs(values->GetComponent(i, 0));
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  return largest;
}

}  // namespace lipofill::client
