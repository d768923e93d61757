#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::client {

using Surface = vtkSmartPointer<vtkPolyData>;

inline constexpr char kDisplacement[] = "displacement_mm";
inline constexpr char kDisplacementLength[] = "displacement_length_mm";
inline constexpr char kPressure[] = "pressure_pa";
inline constexpr char kThickness[] = "thickness_mm";
/// Red, green and blue from 0 to 255, of scans that have colours.
inline constexpr char kScannedColour[] = "colour";

/// Reads a .vtp with any fields or none. One in double precision, which lies far from the origin,
/// is moved there: pictures are drawn in single precision. INVALID_ARGUMENT, naming the file, for
/// one that cannot be read or has no points.
absl::StatusOr<Surface> read_plain_surface(const std::filesystem::path& file);

/// Reads a .vtp in the same way. INVALID_ARGUMENT, naming the file, for one that cannot be read,
/// has no points, or lacks the point field "displacement_mm" of three components or one of
/// `fields`.
absl::StatusOr<Surface> read_surface(const std::filesystem::path& file, const std::vector<std::string>& fields);

/// Adds normals for smooth shading; points and their order stay.
Surface with_normals(vtkPolyData* surface);

/// The surface as it was: its points less their displacement.
Surface at_rest(vtkPolyData* moved);

/// Adds the length of the displacement as a point field.
void add_displacement_length(vtkPolyData* surface);

/// The largest size of the finite values of a point field, 0 without any.
double largest_size(vtkPolyData* surface, const char* field);

}  // namespace lipofill::client
