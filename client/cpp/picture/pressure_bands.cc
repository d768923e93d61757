#include "client/cpp/picture/pressure_bands.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFloatArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <cmath>
#include <vector>

#include "client/cpp/picture/colours.h"

namespace lipofill::client {
namespace {

constexpr int kCuts = 6;    // each side of a triangle is cut so often
constexpr int kRounds = 2;  // of smoothing

/// The fat under a point of the surface.
struct Fat {
  double wet = 0.0;              ///< 1 where there is fat below, else 0; between them near the edge
  double pressure_of_wet = 0.0;  ///< pressure times wet
};

/// A point of the surface with what is interpolated between points.
struct Corner {
  std::array<double, 3> point{};
  std::array<double, 3> normal{};
  Fat fat;
};

Corner mix(const std::array<Corner, 3>& corners, double a, double b) {
  const std::array<double, 3> weights = {1.0 - a - b, a, b};
  Corner mixed;
  for (size_t k = 0; k < 3; ++k) {
    for (size_t i = 0; i < 3; ++i) {
      mixed.point[i] += weights[k] * corners[k].point[i];
      mixed.normal[i] += weights[k] * corners[k].normal[i];
    }
    mixed.fat.wet += weights[k] * corners[k].fat.wet;
    mixed.fat.pressure_of_wet += weights[k] * corners[k].fat.pressure_of_wet;
  }
  return mixed;
}

const Colour& colour_of(const Fat& fat) {
  return fat.wet > 0.5 ? pressure_band_of(fat.pressure_of_wet / fat.wet).colour : kNothing;
}

/// Triangles with points of their own.
class BandedSurface {
 public:
  BandedSurface() {
    normals_->SetNumberOfComponents(3);
    colours_->SetNumberOfComponents(3);
  }

  void add(const std::array<Corner, 3>& corners) {
    const Colour& colour = colour_of(mix(corners, 1.0 / 3.0, 1.0 / 3.0).fat);
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

std::vector<Fat> find_fat(vtkPolyData* surface) {
  vtkDataArray* thickness = surface->GetPointData()->GetArray(kThickness);
  vtkDataArray* pressure = surface->GetPointData()->GetArray(kPressure);
  std::vector<Fat> fat(static_cast<size_t>(surface->GetNumberOfPoints()));
  for (size_t point = 0; point < fat.size(); ++point) {
    const auto id = static_cast<vtkIdType>(point);
    if (thickness->GetComponent(id, 0) > 0.0) fat[point] = {1.0, pressure->GetComponent(id, 0)};
  }
  return fat;
}

/// Mixes what lies under each point with what lies under those around it: half of it is the mean
/// over the cells that meet there. The edge of the fat, where half is wet, no longer follows the
/// sides of triangles.
void smooth(vtkPolyData* surface, std::vector<Fat>& fat) {
  struct Around {
    Fat sum;
    int n = 0;
  };
  std::vector<Around> around(fat.size());
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < surface->GetNumberOfCells(); ++cell) {
    surface->GetCellPoints(cell, ids);
    Fat sum;
    const int n = static_cast<int>(ids->GetNumberOfIds());
    for (int k = 0; k < n; ++k) {
      const Fat& corner = fat[static_cast<size_t>(ids->GetId(k))];
      sum.wet += corner.wet;
      sum.pressure_of_wet += corner.pressure_of_wet;
    }
    for (int k = 0; k < n; ++k) {
      Around& at = around[static_cast<size_t>(ids->GetId(k))];
      at.sum.wet += sum.wet;
      at.sum.pressure_of_wet += sum.pressure_of_wet;
      at.n += n;
    }
  }
  for (size_t point = 0; point < fat.size(); ++point) {
    const Around& at = around[point];
    if (at.n == 0) continue;
    fat[point].wet = 0.5 * (fat[point].wet + at.sum.wet / at.n);
    fat[point].pressure_of_wet = 0.5 * (fat[point].pressure_of_wet + at.sum.pressure_of_wet / at.n);
  }
}

}  // namespace

Surface in_pressure_bands(vtkPolyData* surface) {
  std::vector<Fat> fat = find_fat(surface);
  for (int round = 0; round < kRounds; ++round) smooth(surface, fat);
  const auto corner = [&](vtkIdType id) {
    Corner made;
    surface->GetPoint(id, made.point.data());
    surface->GetPointData()->GetNormals()->GetTuple(id, made.normal.data());
    made.fat = fat[static_cast<size_t>(id)];
    return made;
  };
  BandedSurface banded;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < surface->GetNumberOfCells(); ++cell) {
    surface->GetCellPoints(cell, ids);
    for (vtkIdType k = 2; k < ids->GetNumberOfIds(); ++k) {
      const std::array<Corner, 3> corners = {corner(ids->GetId(0)), corner(ids->GetId(k - 1)), corner(ids->GetId(k))};
      const bool has_fat = corners[0].fat.wet + corners[1].fat.wet + corners[2].fat.wet > 0.0;
      has_fat ? banded.add_cut(corners) : banded.add(corners);
    }
  }
  return banded.take();
}

}  // namespace lipofill::client
