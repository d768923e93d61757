#pragma once

#include "client/cpp/picture/surface.h"

namespace lipofill::client {

/// Makes the surface once more, for the picture of the pressure: cells in the colours of the bands
/// (colours.h), kNothing where no fat is below. Triangles with fat near any of their points are cut
/// into smaller ones, so that bands and zones end in lines that do not follow the sides of
/// triangles: what lies under a point is mixed with what lies around it, the fat ends where half of
/// that is none, and its pressure does not fade towards the edge. Needs point normals and the point
/// fields "pressure_pa" and "thickness_mm". Checked by tests/unit/client/pressure_bands_test.cc.
Surface in_pressure_bands(vtkPolyData* surface);

}  // namespace lipofill::client
