#include "client/cpp/picture/pressure_bands.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <cmath>

#include "client/cpp/picture/colours.h"

namespace lipofill::client {
namespace {

constexpr int kCuts = 6;  // each side of a triangle is cut so often

/// A point of the surface with what is interpolated between points.
struct Corner {
  std::array<double, 3> point{};
  std::array<double, 3> normal{};
  double wet = 0.0;              ///< 1 where there is fat below, else 0
  double pressure_of_wet = 0.0;  ///< pressure times wet
};

Corner mix(const std::array<Corner, 3>& corners, double a, double b) {
  const std::array<double, 3> weights = {1.0 - a - b, a, b};
  Corner mixed;
  for (size_t k = 0; k < 3; ++k) {
    for (size_t i = 0; i < 3; ++i) {
      mixed.point[i] += weights[k] * corners[k].point[i];
      mixed.normal[i] += weights[k] * corners[k].normal[i];
    }
    mixed.wet += weights[k] * corners[k].wet;
    mixed.pressure_of_wet += weights[k] * corners[k].pressure_of_wet;
  }
  return mixed;
}

const Colour& colour_of(const Corner& centre) {
  return centre.wet > 0.5 ? pressure_band_of(centre.pressure_of_wet / centre.wet).colour : kNothing;
}

/// Triangles with points of their own.
class BandedSurface {
 public:
  BandedSurface() {
    normals_->SetNumberOfComponents(3);
    colours_->SetNumberOfComponents(3);
  }

  void add(const std::array<Corner, 3>& corners) {
    const Colour& colour = colour_of(mix(corners, 1.0 / 3.0, 1.0 / 3.0));
    std::array<vtkIdType, 3> ids{};
    for (size_t k = 0; k < 3; ++k) {
      ids[k] = points_->InsertNextPoint(corners[k].point.data());
      normals_->InsertNextTuple(corners[k].normal.data());
    }
    triangles_->InsertNextCell(3, ids.data());
    std::array<double, 3> bytes{};
    for (size_t c = 0; c < 3; ++c) bytes[c] = std::round(255.0 * colour[c]);
    colours_->InsertNextTuple(bytes.data());
  }

  void add_cut(const std::array<Corner, 3>& corners) {
    const auto at = [&](int i, int j) { return mix(corners, 1.0 * i / kCuts, 1.0 * j / kCuts); };
    for (int i = 0; i < kCuts; ++i) {
      for (int j = 0; i + j < kCuts; ++j) {
        add({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < kCuts) add({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }

  Surface take() const {
    auto surface = Surface::New();
    surface->SetPoints(points_);
    surface->SetPolys(triangles_);
    surface->GetPointData()->SetNormals(normals_);
    surface->GetCellData()->SetScalars(colours_);
    return surface;
  }

 private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkFloatArray> normals_;
  vtkNew<vtkCellArray> triangles_;
  vtkNew<vtkUnsignedCharArray> colours_;
};

Corner corner_of(vtkPolyData* surface, vtkIdType id) {
  vtkPointData* fields = surface->GetPointData();
  Corner corner;
  surface->GetPoint(id, corner.point.data());
  fields->GetNormals()->GetTuple(id, corner.normal.data());
  corner.wet = fields->GetArray(kThickness)->GetComponent(id, 0) > 0.0 ? 1.0 : 0.0;
  corner.pressure_of_wet = corner.wet > 0.0 ? fields->GetArray(kPressure)->GetComponent(id, 0) : 0.0;
  return corner;
}

}  // namespace

Surface in_pressure_bands(vtkPolyData* surface) {
  BandedSurface banded;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < surface->GetNumberOfCells(); ++cell) {
    surface->GetCellPoints(cell, ids);
    for (vtkIdType k = 2; k < ids->GetNumberOfIds(); ++k) {
      const std::array<Corner, 3> corners = {corner_of(surface, ids->GetId(0)), corner_of(surface, ids->GetId(k - 1)),
                                             corner_of(surface, ids->GetId(k))};
      const bool has_fat = corners[0].wet + corners[1].wet + corners[2].wet > 0.0;
      has_fat ? banded.add_cut(corners) : banded.add(corners);
    }
  }
  return banded.take();
}

}  // namespace lipofill::client
