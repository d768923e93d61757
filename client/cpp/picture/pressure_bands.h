#pragma once

#include "client/cpp/picture/surface.h"

namespace lipofill::client {

/// The surface once more, for the picture of the pressure: cells in the colours of the bands
/// (colours.h), kNothing where no fat is below. Triangles with fat below any of their points are
/// cut into smaller ones, so that bands and zones end in smooth lines: between a point with fat and
/// one without the fat ends half-way, and its pressure does not fade towards the edge. Needs point
/// normals and the point fields "pressure_pa" and "thickness_mm".
Surface in_pressure_bands(vtkPolyData* surface);

}  // namespace lipofill::client
