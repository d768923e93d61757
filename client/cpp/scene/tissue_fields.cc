#include "client/cpp/scene/tissue_fields.h"

#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/cpp/io/result_folder.h"
#include "client/cpp/io/vtk_messages.h"

namespace lipofill::client {
namespace {

using Corners = Eigen::Matrix<double, 3, 8>;
using Eigen::Matrix3d;
constexpr double kKpaPerMpa = 1000.0;

/// Slopes of the trilinear functions at the centre, by the parent's coordinates, a column a corner.
Corners slopes_at_centre() {
  Corners signs;
  signs << -1, 1, 1, -1, -1, 1, 1, -1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1, -1, -1, 1, 1, 1, 1;
  return signs / 8.0;
}

double size_of_deviator(const Matrix3d& tensor, double factor) {
  const Matrix3d deviator = tensor - tensor.trace() / 3.0 * Matrix3d::Identity();
  return std::sqrt(factor * deviator.squaredNorm());
}

Matrix3d corotational_stress(const Matrix3d& gradient, const DeckLayer& layer) {
  const Eigen::JacobiSVD<Matrix3d> svd(gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  const Matrix3d strain = rotation.transpose() * gradient - Matrix3d::Identity();
  const double lame = layer.bulk_modulus_mpa - 2.0 / 3.0 * layer.shear_modulus_mpa;
  const Matrix3d stress = 2.0 * layer.shear_modulus_mpa * strain + lame * strain.trace() * Matrix3d::Identity();
  return rotation * stress * rotation.transpose();
}

Matrix3d neo_hookean_stress(const Matrix3d& gradient, const DeckLayer& layer) {
  const double ratio = gradient.determinant();
  const Matrix3d left = gradient * gradient.transpose();
  const Matrix3d deviator = left - left.trace() / 3.0 * Matrix3d::Identity();
  return layer.shear_modulus_mpa * std::pow(ratio, -5.0 / 3.0) * deviator +
         layer.bulk_modulus_mpa * (ratio - 1.0) * Matrix3d::Identity();
}

absl::StatusOr<vtkSmartPointer<vtkUnstructuredGrid>> read_tissue(const std::filesystem::path& folder) {
  const std::filesystem::path file = last_frame_file(folder, "tissue");
  if (file.empty())
    return absl::InvalidArgumentError(absl::StrCat(folder.string(), " has no tissue: no tissue_NNNN.vtu is there"));
  const VtkMessages messages;
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkSmartPointer<vtkUnstructuredGrid> grid = reader->GetOutput();
  if (!messages.error().empty() || grid->GetPointData()->GetArray("displacement_mm") == nullptr)
    return absl::InvalidArgumentError(absl::StrCat(file.string(), " is no tissue with displacement_mm on its points"));
  return grid;
}

/// The corners of a cell, at rest and moved; false for what is no hexahedron.
bool corners_of(vtkUnstructuredGrid* grid, vtkIdType cell, Corners* rest, Corners* moved) {
  vtkDataArray* const displacement = grid->GetPointData()->GetArray("displacement_mm");
  vtkNew<vtkIdList> points;
  grid->GetCellPoints(cell, points);
  if (grid->GetCellType(cell) != VTK_HEXAHEDRON || points->GetNumberOfIds() != 8) return false;
  for (int k = 0; k < 8; ++k) {
    Eigen::Vector3d u;
    grid->GetPoint(points->GetId(k), moved->col(k).data());
    displacement->GetTuple(points->GetId(k), u.data());
    rest->col(k) = moved->col(k) - u;
  }
  return true;
}

vtkSmartPointer<vtkDoubleArray> add_field(const char* name, vtkUnstructuredGrid* grid) {
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfTuples(grid->GetNumberOfCells());
  grid->GetCellData()->AddArray(array);
  return array;
}

absl::Status add_fields(const DeckLayers& deck, vtkUnstructuredGrid* grid) {
  vtkNew<vtkIntArray> layers;
  layers->SetName("layer");
  const auto ratio = add_field("volume_ratio", grid), largest = add_field("largest_strain", grid),
             strain = add_field("equivalent_strain", grid), von_mises = add_field("von_mises_stress_kpa", grid),
             mean = add_field("mean_stress_kpa", grid);
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
    const size_t layer = deck.layer_of_cell[static_cast<size_t>(cell)];
    Corners rest, moved;
    if (layer >= deck.layers.size() || !corners_of(grid, cell, &rest, &moved))
      return absl::InvalidArgumentError(absl::StrCat("cell ", cell, " is no hexahedron of a layer of the deck"));
    const CellFields fields = compute_cell_fields(rest, moved, deck.layers[layer]);
    layers->InsertNextValue(static_cast<int>(layer) + 1);
    ratio->SetValue(cell, fields.volume_ratio);
    largest->SetValue(cell, fields.largest_strain);
    strain->SetValue(cell, fields.equivalent_strain);
    von_mises->SetValue(cell, fields.von_mises_stress_kpa);
    mean->SetValue(cell, fields.mean_stress_kpa);
  }
  grid->GetCellData()->AddArray(layers);
  vtkNew<vtkStringArray> names;
  names->SetName("layer_names");
  for (const DeckLayer& layer : deck.layers) names->InsertNextValue(layer.name);
  grid->GetFieldData()->AddArray(names);
  return absl::OkStatus();
}

}  // namespace

CellFields compute_cell_fields(const Corners& rest, const Corners& moved, const DeckLayer& layer) {
  static const Corners slopes = slopes_at_centre();
  const Matrix3d gradient = (moved * slopes.transpose()) * (rest * slopes.transpose()).inverse();
  const Matrix3d strain = 0.5 * (gradient.transpose() * gradient - Matrix3d::Identity());
  const Matrix3d stress =
      layer.neo_hookean ? neo_hookean_stress(gradient, layer) : corotational_stress(gradient, layer);
  CellFields fields;
  fields.volume_ratio = gradient.determinant();
  fields.largest_strain = Eigen::SelfAdjointEigenSolver<Matrix3d>(strain, Eigen::EigenvaluesOnly).eigenvalues()[2];
  fields.equivalent_strain = size_of_deviator(strain, 2.0 / 3.0);
  fields.von_mises_stress_kpa = kKpaPerMpa * size_of_deviator(stress, 1.5);
  fields.mean_stress_kpa = kKpaPerMpa * stress.trace() / 3.0;
  return fields;
}

absl::Status write_tissue_fields(const std::filesystem::path& folder, const std::filesystem::path& deck,
                                 const std::filesystem::path& out) {
  const auto layers = read_deck_layers(deck);
  if (!layers.ok()) return layers.status();
  const auto grid = read_tissue(folder);
  if (!grid.ok()) return grid.status();
  if (static_cast<vtkIdType>(layers->layer_of_cell.size()) != (*grid)->GetNumberOfCells()) {
    return absl::InvalidArgumentError(absl::StrCat(deck.string(), " has ", layers->layer_of_cell.size(),
                                                   " hexahedra, the tissue of ", folder.string(), " has ",
                                                   (*grid)->GetNumberOfCells(), ": it is the deck of another model"));
  }
  if (auto status = add_fields(*layers, *grid); !status.ok()) return status;
  const VtkMessages messages;
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetFileName(out.c_str());
  writer->SetInputData(*grid);
  if (writer->Write() != 1 || !messages.error().empty())
    return absl::InvalidArgumentError(absl::StrCat("cannot write ", out.string(), ": ", messages.error()));
  return absl::OkStatus();
}

}  // namespace lipofill::client
