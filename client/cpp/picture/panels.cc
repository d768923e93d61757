#include "client/cpp/picture/panels.h"

#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkAutoInit.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkCoordinate.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkWindowToImageFilter.h>

#include <array>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cpp/io/vtk_messages.h"
#include "client/cpp/picture/surface.h"

VTK_MODULE_INIT(vtkRenderingOpenGL2)
VTK_MODULE_INIT(vtkRenderingFreeType)

namespace lipofill::client {
namespace {

constexpr int kBarSteps = 128;
constexpr int kBarLabels = 5;
constexpr int kBarTextSize = 22;

void set_camera(const View& view, vtkRenderer* renderer) {
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetParallelScale(view.half_height_mm);
  camera->SetFocalPoint(view.focus.data());
  const double distance = 10.0 * view.half_height_mm;
  camera->SetPosition(view.focus[0] + distance * view.direction[0], view.focus[1] + distance * view.direction[1],
                      view.focus[2] + distance * view.direction[2]);
  camera->SetViewUp(view.up.data());
  renderer->ResetCameraClippingRange();
}

/// A lamp from above and beside the camera, and a weak one at the camera: hollows and bulges show
/// by their shading.
void set_lights(vtkRenderer* renderer) {
  renderer->AutomaticLightCreationOff();
  for (const auto& [x, y, z, intensity] : {std::array{-0.9, 0.8, 1.0, 0.75}, std::array{0.3, 0.0, 1.0, 0.42}}) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(x, y, z);
    light->SetFocalPoint(0, 0, 0);
    light->SetIntensity(intensity);
    renderer->AddLight(light);
  }
}

void set_paint(const Paint& paint, vtkPolyDataMapper* mapper, vtkProperty* property) {
  const bool is_skin = paint.kind == Paint::Kind::kPlain;
  const bool is_scanned = is_skin && mapper->GetInput()->GetPointData()->HasArray(kScannedColour) != 0;
  mapper->SetScalarVisibility(!is_skin || is_scanned);
  if (is_scanned) {
    mapper->SetScalarModeToUsePointFieldData();
    mapper->SelectColorArray(kScannedColour);
    mapper->SetColorModeToDirectScalars();
  } else if (paint.kind == Paint::Kind::kPointField) {
    mapper->SetScalarModeToUsePointFieldData();
    mapper->SelectColorArray(paint.field);
    mapper->SetLookupTable(paint.colours);
  } else if (paint.kind == Paint::Kind::kCellColours) {
    mapper->SetScalarModeToUseCellData();
  }
  property->SetColor(kSkin[0], kSkin[1], kSkin[2]);
  property->SetInterpolationToPhong();
  property->SetAmbient(is_skin ? 0.12 : 0.3);
  property->SetDiffuse(is_skin ? 0.9 : 0.75);
  property->SetSpecular(is_skin ? 0.08 : 0.0);
  property->SetSpecularPower(20);
}

}  // namespace

vtkSmartPointer<vtkRenderer> panel(const Area& area, vtkPolyData* surface, const View& view, const Paint& paint) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(surface);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  set_paint(paint, mapper, actor->GetProperty());
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->SetViewport(area.left, area.bottom, area.right, area.top);
  renderer->SetBackground(1, 1, 1);
  renderer->AddActor(actor);
  set_lights(renderer);
  set_camera(view, renderer);
  return renderer;
}

Overlay::Overlay() : renderer_(vtkSmartPointer<vtkRenderer>::New()) {
  renderer_->SetLayer(1);
}

void Overlay::add_text(const std::string& text, int size, double x, double y, Align align) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  vtkTextProperty* style = actor->GetTextProperty();
  style->SetFontSize(size);
  style->SetColor(kInk[0], kInk[1], kInk[2]);
  style->SetVerticalJustificationToCentered();
  if (align == Align::kCentre) style->SetJustificationToCentered();
  if (align == Align::kRight) style->SetJustificationToRight();
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->SetPosition(x, y);
  renderer_->AddActor2D(actor);
}

void Overlay::add_box(const Area& area, const Colour& colour) {
  vtkNew<vtkPoints> corners;
  corners->InsertNextPoint(area.left, area.bottom, 0);
  corners->InsertNextPoint(area.right, area.bottom, 0);
  corners->InsertNextPoint(area.right, area.top, 0);
  corners->InsertNextPoint(area.left, area.top, 0);
  const std::array<vtkIdType, 4> order = {0, 1, 2, 3};
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell(4, order.data());
  vtkNew<vtkPolyData> box;
  box->SetPoints(corners);
  box->SetPolys(cells);
  vtkNew<vtkCoordinate> coordinates;
  coordinates->SetCoordinateSystemToNormalizedViewport();
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(box);
  mapper->SetTransformCoordinate(coordinates);
  vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  renderer_->AddActor2D(actor);
}

void Overlay::add_bar(const Area& area, vtkColorTransferFunction* colours) {
  const double* range = colours->GetRange();
  const double height = area.top - area.bottom;
  const auto at = [&](double share) { return range[0] + share * (range[1] - range[0]); };
  for (int i = 0; i < kBarSteps; ++i) {
    Colour colour{};
    colours->GetColor(at((i + 0.5) / kBarSteps), colour.data());
    add_box({area.left, area.bottom + height * i / kBarSteps, area.right, area.bottom + height * (i + 1) / kBarSteps},
            colour);
  }
  for (int i = 0; i < kBarLabels; ++i) {
    const double share = static_cast<double>(i) / (kBarLabels - 1);
    add_text(absl::StrFormat("%.1f", at(share)), kBarTextSize, area.right + 0.006, area.bottom + share * height);
  }
}

absl::Status write_png(const std::filesystem::path& png, const Sheet& sheet) {
  vtkNew<vtkRenderWindow> window;
  window->OffScreenRenderingOn();
  window->SetMultiSamples(8);
  window->SetSize(sheet.width, sheet.height);
  window->SetNumberOfLayers(2);
  vtkNew<vtkRenderer> paper;
  paper->SetBackground(1, 1, 1);
  window->AddRenderer(paper);
  for (const auto& renderer : sheet.panels) window->AddRenderer(renderer);
  window->AddRenderer(sheet.overlay.renderer());
  window->Render();
  const VtkMessages messages;
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(png.c_str());
  writer->SetInputConnection(image->GetOutputPort());
  writer->Write();
  if (messages.error().empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("cannot write ", png.string(), ": ", messages.error()));
}

}  // namespace lipofill::client
