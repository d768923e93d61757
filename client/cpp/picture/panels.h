#pragma once

#include <vtkColorTransferFunction.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/cpp/picture/colours.h"
#include "client/cpp/picture/view.h"

namespace lipofill::client {

/// Part of a sheet, as shares of its width and height from the lower left corner.
struct Area {
  double left = 0.0;
  double bottom = 0.0;
  double right = 1.0;
  double top = 1.0;
};

/// The way a surface is painted.
struct Paint {
  enum class Kind { kPlain, kPointField, kCellColours };
  Kind kind = Kind::kPlain;                     ///< kPlain has the colours that were scanned, or that of skin
  const char* field = nullptr;                  ///< kPointField shows it
  vtkColorTransferFunction* colours = nullptr;  ///< kPointField shows it
};

/// A view of a surface in a part of the sheet. Precondition: the surface has point normals.
vtkSmartPointer<vtkRenderer> panel(const Area& area, vtkPolyData* surface, const View& view, const Paint& paint);

/// Text and lines drawn over the panels.
class Overlay {
 public:
  Overlay();

  enum class Align { kLeft, kCentre, kRight };
  void add_text(const std::string& text, int size, double x, double y, Align align = Align::kLeft);
  void add_box(const Area& area, const Colour& colour);
  /// A bar of colours with numbers beside it, from the lowest to the highest of its function.
  void add_bar(const Area& area, vtkColorTransferFunction* colours);

  vtkRenderer* renderer() const { return renderer_; }

 private:
  vtkSmartPointer<vtkRenderer> renderer_;
};

/// A sheet of pixels.
struct Sheet {
  int width = 0;
  int height = 0;
  std::vector<vtkSmartPointer<vtkRenderer>> panels;
  Overlay overlay;
};

/// Draws off the screen and writes. INVALID_ARGUMENT for a file that cannot be written.
absl::Status write_png(const std::filesystem::path& png, const Sheet& sheet);

}  // namespace lipofill::client
