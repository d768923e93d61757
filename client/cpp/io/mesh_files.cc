#include "client/cpp/io/mesh_files.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedIntArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cstring>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "client/cpp/io/vtk_messages.h"
#include "client/cpp/json_file.h"

namespace lipofill::client {
namespace {

absl::Status misfit(const Array& array, const char* what) {
  return absl::DataLossError(absl::StrCat("array '", array.name, "' ", what));
}

absl::Status check_geometry(const MeshView& mesh) {
  if (mesh.points == nullptr || mesh.cells == nullptr) {
    return absl::DataLossError(absl::StrCat("mesh '", mesh.name, "' lacks its points or cells"));
  }
  if (!mesh.points->has_points() || mesh.points->columns() != 3)
    return misfit(*mesh.points, "is not (n, 3) float32 or float64");
  const size_t corners = mesh.cells->columns();
  if (mesh.cells->type != ElementType::kUint32 || (corners != 3 && corners != 4 && corners != 8)) {
    return misfit(*mesh.cells, "is not (n, 3 or 4 or 8) uint32");
  }
  const size_t n_points = mesh.points->rows();
  const auto indices = mesh.cells->uint32s();
  if (std::any_of(indices.begin(), indices.end(), [n_points](uint32_t index) { return index >= n_points; })) {
    return misfit(*mesh.cells, "has an index outside the points");
  }
  return absl::OkStatus();
}

absl::Status check_field(const MeshView& mesh, const Array& field) {
  const size_t expected = field.location == ArrayLocation::kCell ? mesh.cells->rows() : mesh.points->rows();
  if (field.rows() != expected) return misfit(field, "has another length than its mesh");
  if (field.field() == "displacement" && (field.type != ElementType::kFloat32 || field.columns() != 3)) {
    return misfit(field, "is not (n, 3) float32");
  }
  return absl::OkStatus();
}

template <typename VtkArray, typename Value>
vtkSmartPointer<vtkDataArray> copy_values(std::span<const Value> values, size_t columns) {
  auto array = vtkSmartPointer<VtkArray>::New();
  array->SetNumberOfComponents(static_cast<int>(columns));
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size() / columns));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

vtkSmartPointer<vtkDataArray> vtk_array(const Array& field) {
  vtkSmartPointer<vtkDataArray> array;
  switch (field.type) {
    case ElementType::kFloat32:
      array = copy_values<vtkFloatArray>(field.floats(), field.columns());
      break;
    case ElementType::kUint32:
      array = copy_values<vtkUnsignedIntArray>(field.uint32s(), field.columns());
      break;
    case ElementType::kUint8:
      array = copy_values<vtkUnsignedCharArray>(field.uint8s(), field.columns());
      break;
    case ElementType::kFloat64:
      array = copy_values<vtkDoubleArray>(field.doubles(), field.columns());
      break;
  }
  array->SetName(field_name(field).c_str());
  return array;
}

template <typename Value>
void move_points(std::span<const Value> rest, const Array* displacement, vtkPoints* points) {
  auto* values = static_cast<Value*>(points->GetVoidPointer(0));
  std::copy(rest.begin(), rest.end(), values);
  if (displacement == nullptr) return;
  const auto moved = displacement->floats();
  for (size_t i = 0; i < rest.size(); ++i) values[i] += moved[i];
}

/// In the precision in which they came.
vtkSmartPointer<vtkPoints> moved_points(const MeshView& mesh) {
  const auto found = std::find_if(mesh.fields.begin(), mesh.fields.end(),
                                  [](const Array* field) { return field->field() == "displacement"; });
  const Array* displacement = found == mesh.fields.end() ? nullptr : *found;
  const bool is_double = mesh.points->type == ElementType::kFloat64;
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataType(is_double ? VTK_DOUBLE : VTK_FLOAT);
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.points->rows()));
  if (is_double) {
    move_points(mesh.points->doubles(), displacement, points);
  } else {
    move_points(mesh.points->floats(), displacement, points);
  }
  return points;
}

vtkSmartPointer<vtkCellArray> vtk_cells(const MeshView& mesh) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  const auto corners = static_cast<vtkIdType>(mesh.cells->columns());
  const auto indices = mesh.cells->uint32s();
  cells->AllocateExact(static_cast<vtkIdType>(mesh.cells->rows()), static_cast<vtkIdType>(indices.size()));
  std::vector<vtkIdType> cell(static_cast<size_t>(corners));
  for (size_t i = 0; i < mesh.cells->rows(); ++i) {
    std::copy_n(indices.begin() + static_cast<std::ptrdiff_t>(i * cell.size()), cell.size(), cell.begin());
    cells->InsertNextCell(corners, cell.data());
  }
  return cells;
}

void add_fields(const MeshView& mesh, vtkDataSet* data) {
  for (const Array* field : mesh.fields) {
    vtkDataSetAttributes* attributes = field->location == ArrayLocation::kCell
                                           ? static_cast<vtkDataSetAttributes*>(data->GetCellData())
                                           : static_cast<vtkDataSetAttributes*>(data->GetPointData());
    attributes->AddArray(vtk_array(*field));
  }
}

template <typename Writer, typename Data>
absl::Status write_data(const std::filesystem::path& file, Data* data) {
  const VtkMessages messages;
  vtkNew<Writer> writer;
  writer->SetFileName(file.c_str());
  writer->SetInputData(data);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetCompressorTypeToZLib();
  if (writer->Write() != 1 || !messages.error().empty()) {
    return absl::InvalidArgumentError(absl::StrCat("cannot write ", file.string(), ": ", messages.error()));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<MeshView>> mesh_views(std::span<const Array> meshes, std::span<const Array> fields) {
  std::vector<MeshView> views;
  const auto view_of = [&views](std::string_view name) {
    return std::find_if(views.begin(), views.end(), [name](const MeshView& view) { return view.name == name; });
  };
  for (const Array& array : meshes) {
    auto view = view_of(array.mesh());
    if (view == views.end())
      view = views.insert(views.end(), MeshView{std::string(array.mesh()), nullptr, nullptr, {}});
    if (array.field() == "points")
      view->points = &array;
    else if (array.field() == "cells")
      view->cells = &array;
    else
      view->fields.push_back(&array);
  }
  for (const Array& field : fields) {
    const auto view = view_of(field.mesh());
    if (view == views.end()) return misfit(field, "belongs to no mesh");
    view->fields.push_back(&field);
  }
  for (const MeshView& view : views) {
    if (auto status = check_geometry(view); !status.ok()) return status;
    for (const Array* field : view.fields) {
      if (auto status = check_field(view, *field); !status.ok()) return status;
    }
  }
  return views;
}

const char* mesh_extension(const MeshView& mesh) {
  return mesh.cells->columns() == 8 ? ".vtu" : ".vtp";
}

std::string field_name(const Array& field) {
  std::string name(field.field());
  if (field.unit.empty()) return name;
  return absl::StrCat(name, "_", absl::AsciiStrToLower(absl::StrReplaceAll(field.unit, {{"/", "_per_"}, {" ", "_"}})));
}

absl::Status write_mesh(const std::filesystem::path& file, const MeshView& mesh) {
  if (mesh.cells->columns() == 8) {
    vtkNew<vtkUnstructuredGrid> grid;
    grid->SetPoints(moved_points(mesh));
    grid->SetCells(VTK_HEXAHEDRON, vtk_cells(mesh));
    add_fields(mesh, grid);
    return write_data<vtkXMLUnstructuredGridWriter>(file, grid.Get());
  }
  vtkNew<vtkPolyData> surface;
  surface->SetPoints(moved_points(mesh));
  surface->SetPolys(vtk_cells(mesh));
  add_fields(mesh, surface);
  return write_data<vtkXMLPolyDataWriter>(file, surface.Get());
}

absl::Status write_collection(const std::filesystem::path& file,
                              const std::vector<std::pair<double, std::string>>& time_and_file) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  "
      "<Collection>\n";
  for (const auto& [time, name] : time_and_file) {
    absl::StrAppendFormat(&text, "    <DataSet timestep=\"%.9g\" group=\"\" part=\"0\" file=\"%s\"/>\n", time, name);
  }
  return write_text_file(file, text + "  </Collection>\n</VTKFile>\n");
}

}  // namespace lipofill::client
