#include "client/cpp/picture/scan_picture.h"

#include <vtkActor.h>
#include <vtkFeatureEdges.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <algorithm>
#include <array>

#include "absl/strings/str_cat.h"
#include "client/cpp/picture/panels.h"
#include "client/cpp/picture/surface.h"

namespace lipofill::client {
namespace {

constexpr int kHeadingSize = 28;
constexpr int kTextSize = 22;
constexpr double kLine = 0.03;
constexpr size_t kMostLines = 10;

struct Side {
  const char* label;
  std::array<double, 3> direction;
  std::array<double, 3> up;
};

/// The front of a face whose file has y up is the first, of one with z up and y to the back the
/// third.
constexpr std::array<Side, 3> kSides = {
    {{"from +z", {0, 0, 1}, {0, 1, 0}}, {"from +x", {1, 0, 0}, {0, 1, 0}}, {"from -y", {0, -1, 0}, {0, 0, 1}}}};

vtkSmartPointer<vtkActor> draw_borders(vtkPolyData* surface) {
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputData(surface);
  edges->BoundaryEdgesOn();
  edges->NonManifoldEdgesOn();
  edges->FeatureEdgesOff();
  edges->ManifoldEdgesOff();
  edges->ColoringOff();
  edges->Update();
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(edges->GetOutput());
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.8, 0.1, 0.1);
  actor->GetProperty()->SetLineWidth(3.0);
  actor->GetProperty()->LightingOff();
  return actor;
}

View look_from(const Side& side, vtkPolyData* surface) {
  View view;
  surface->GetCenter(view.focus.data());
  view.direction = side.direction;
  view.up = side.up;
  view.half_height_mm = 0.45 * surface->GetLength();
  return view;
}

}  // namespace

absl::Status draw_scan_picture(const PictureRequest& request) {
  const auto surface = read_plain_surface(request.mesh);
  if (!surface.ok()) return surface.status();
  const Surface shaded = with_normals(*surface);
  const size_t lines = std::min(request.remarks.size(), kMostLines);
  const double bottom = 0.05 + kLine * static_cast<double>(lines);
  Sheet sheet{2100, 1000, {}, {}};
  for (size_t k = 0; k < kSides.size(); ++k) {
    const double left = static_cast<double>(k) / 3.0;
    const Area area{left, bottom, left + 1.0 / 3.0, 0.94};
    sheet.panels.push_back(panel(area, shaded, look_from(kSides[k], shaded), {}));
    sheet.panels.back()->AddActor(draw_borders(shaded));
    sheet.overlay.add_text(kSides[k].label, kHeadingSize, left + 1.0 / 6.0, 0.965, Overlay::Align::kCentre);
  }
  for (size_t k = 0; k < lines; ++k) {
    const bool is_cut = k + 1 == kMostLines && request.remarks.size() > kMostLines;
    const std::string text = is_cut ? absl::StrCat("  and ", request.remarks.size() - k, " more") : request.remarks[k];
    sheet.overlay.add_text(text, kTextSize, 0.012, bottom - kLine * (static_cast<double>(k) + 0.5));
  }
  sheet.overlay.add_text(request.caption, kTextSize, 0.012, 0.025);
  return write_png(request.png, sheet);
}

}  // namespace lipofill::client
