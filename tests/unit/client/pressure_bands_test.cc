// The picture of the pressure: where the fat ends and which band it is in.

#include "client/cpp/picture/pressure_bands.h"

#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFloatArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>
#include <cmath>

#include "client/cpp/picture/colours.h"

namespace lipofill::client {
namespace {

constexpr int kSide = 25;         // points along a side, 2 mm apart
constexpr double kSpacing = 2.0;  // [mm]
constexpr double kMiddle = 24.0;  // [mm]
constexpr double kRadius = 14.0;  // of the fat [mm]

/// A plane of triangles with fat of one pressure under a disc.
Surface make_plane(double pressure) {
  auto surface = Surface::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> normals, pressures, thicknesses;
  normals->SetNumberOfComponents(3);
  pressures->SetName(kPressure);
  thicknesses->SetName(kThickness);
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const double x = i * kSpacing, y = j * kSpacing;
      points->InsertNextPoint(x, y, 0.0);
      normals->InsertNextTuple3(0.0, 0.0, 1.0);
      const bool is_wet = std::hypot(x - kMiddle, y - kMiddle) < kRadius;
      pressures->InsertNextValue(static_cast<float>(is_wet ? pressure : 0.0));
      thicknesses->InsertNextValue(is_wet ? 1.0F : 0.0F);
    }
  }
  surface->SetPoints(points);
  surface->Allocate();
  for (int j = 0; j + 1 < kSide; ++j) {
    for (int i = 0; i + 1 < kSide; ++i) {
      const vtkIdType a = j * kSide + i;
      const vtkIdType lower[] = {a, a + 1, a + kSide + 1}, upper[] = {a, a + kSide + 1, a + kSide};
      surface->InsertNextCell(VTK_TRIANGLE, 3, lower);
      surface->InsertNextCell(VTK_TRIANGLE, 3, upper);
    }
  }
  surface->GetPointData()->SetNormals(normals);
  surface->GetPointData()->AddArray(pressures);
  surface->GetPointData()->AddArray(thicknesses);
  return surface;
}

bool has_colour(vtkDataArray* colours, vtkIdType cell, const Colour& colour) {
  for (int c = 0; c < 3; ++c) {
    if (colours->GetComponent(cell, c) != std::round(255.0 * colour[static_cast<size_t>(c)])) return false;
  }
  return true;
}

struct Painted {
  double area = 0.0;                ///< in the colour asked for [mm2]
  double inner = 1e9, outer = 0.0;  ///< distances from the middle of cells without it and with it [mm]
};

Painted look_at(const Surface& surface, const Colour& colour) {
  Painted painted;
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < surface->GetNumberOfCells(); ++cell) {
    surface->GetCellPoints(cell, ids);
    double p[3][3], x = 0.0, y = 0.0;
    for (int k = 0; k < 3; ++k) {
      surface->GetPoint(ids->GetId(k), p[k]);
      x += p[k][0] / 3.0;
      y += p[k][1] / 3.0;
    }
    const double away = std::hypot(x - kMiddle, y - kMiddle);
    if (!has_colour(surface->GetCellData()->GetScalars(), cell, colour)) {
      painted.inner = std::min(painted.inner, away);
      continue;
    }
    painted.outer = std::max(painted.outer, away);
    painted.area +=
        0.5 * std::abs((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]));
  }
  return painted;
}

TEST(PressureBands, TheEdgeOfTheFatDoesNotFollowTriangles) {
  const Surface plane = make_plane(1000.0);
  const Painted painted = look_at(in_pressure_bands(plane), pressure_band_of(1000.0).colour);
  double of_wet_points = 0.0;
  for (vtkIdType id = 0; id < plane->GetNumberOfPoints(); ++id) {
    if (plane->GetPointData()->GetArray(kThickness)->GetComponent(id, 0) > 0.0) of_wet_points += kSpacing * kSpacing;
  }
  EXPECT_NEAR(painted.area, of_wet_points, 0.03 * of_wet_points);
  // Points are 2 mm apart, 2.8 along a diagonal: lines half-way between them would leave 2 mm.
  EXPECT_LT(painted.outer - painted.inner, 1.2);
}

TEST(PressureBands, ThePressureDoesNotFadeTowardsTheEdge) {
  // Above the last bound of the bands everywhere, however near to where there is none.
  const double high = 10e3;
  const Surface surface = in_pressure_bands(make_plane(high));
  const Painted painted = look_at(surface, pressure_band_of(high).colour);
  const Painted nothing = look_at(surface, kNothing);
  double all = 0.0;
  for (const PressureBand& band : kPressureBands) all += look_at(surface, band.colour).area;
  EXPECT_NEAR(painted.area, all, 1e-9);
  EXPECT_NEAR(painted.area + nothing.area, (kSide - 1) * (kSide - 1) * kSpacing * kSpacing, 1e-6);
}

}  // namespace
}  // namespace lipofill::client
