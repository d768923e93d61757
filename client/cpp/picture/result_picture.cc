#include "client/cpp/picture/result_picture.h"

#include <vtkActor.h>
#include <vtkAutoInit.h>
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkFloatArray.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkWindowToImageFilter.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/io/vtk_messages.h"
#include "client/cpp/picture/view.h"

VTK_MODULE_INIT(vtkRenderingOpenGL2)
VTK_MODULE_INIT(vtkRenderingFreeType)

namespace lipofill::client {
namespace {

using Surface = vtkSmartPointer<vtkPolyData>;

constexpr int kWidth = 2100;
constexpr int kHeight = 800;
constexpr double kTitleStrip = 0.92;
constexpr double kPanelWidth = 0.31;  // the rest is for the legend
constexpr double kSkin[3] = {0.87, 0.70, 0.60};
constexpr double kInk[3] = {0.12, 0.12, 0.14};
constexpr char kDisplacement[] = "displacement_mm";
constexpr char kLength[] = "displacement_length_mm";
constexpr char kDistance[] = "distance_mm";

absl::StatusOr<Surface> read_surface(const std::filesystem::path& file) {
  const VtkMessages messages;
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  Surface surface = reader->GetOutput();
  if (!messages.error().empty() || surface->GetNumberOfPoints() == 0) {
    return absl::InvalidArgumentError(absl::StrCat("cannot read the mesh ", file.string(), " ", messages.error()));
  }
  vtkDataArray* displacement = surface->GetPointData()->GetArray(kDisplacement);
  if (displacement == nullptr || displacement->GetNumberOfComponents() != 3) {
    return absl::InvalidArgumentError(absl::StrCat(file.string(), " has no point field ", kDisplacement));
  }
  return surface;
}

/// Smooth shading needs normals; points and their order stay.
Surface with_normals(vtkPolyData* surface) {
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(surface);
  normals->SplittingOff();
  normals->ConsistencyOff();
  normals->Update();
  return normals->GetOutput();
}

/// The surface as it was: its points less their displacement.
Surface at_rest(vtkPolyData* moved) {
  auto rest = Surface::New();
  rest->DeepCopy(moved);
  vtkDataArray* displacement = moved->GetPointData()->GetArray(kDisplacement);
  for (vtkIdType i = 0; i < moved->GetNumberOfPoints(); ++i) {
    const double* point = moved->GetPoint(i);
    rest->GetPoints()->SetPoint(i, point[0] - displacement->GetComponent(i, 0),
                                point[1] - displacement->GetComponent(i, 1),
                                point[2] - displacement->GetComponent(i, 2));
  }
  return rest;
}

void add_displacement_length(vtkPolyData* surface) {
  vtkDataArray* displacement = surface->GetPointData()->GetArray(kDisplacement);
  vtkNew<vtkFloatArray> length;
  length->SetName(kLength);
  length->SetNumberOfTuples(surface->GetNumberOfPoints());
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
    length->SetValue(i,
                     static_cast<float>(std::hypot(displacement->GetComponent(i, 0), displacement->GetComponent(i, 1),
                                                   displacement->GetComponent(i, 2))));
  }
  surface->GetPointData()->AddArray(length);
}

double largest_size(vtkPolyData* surface, const char* field) {
  vtkDataArray* values = surface->GetPointData()->GetArray(field);
  double largest = 0.0;
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) {
    const double value = std::abs(values->GetComponent(i, 0));
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  return largest;
}

/// Skin where nothing moved, then through yellow and red to dark: lightness falls all the way, so it also reads without
/// colour.
vtkSmartPointer<vtkColorTransferFunction> displacement_colours(double largest) {
  auto colours = vtkSmartPointer<vtkColorTransferFunction>::New();
  const double top = largest > 0.0 ? largest : 1.0;
  colours->AddRGBPoint(0.0, 0.93, 0.91, 0.89);
  colours->AddRGBPoint(0.25 * top, 0.99, 0.84, 0.46);
  colours->AddRGBPoint(0.5 * top, 0.97, 0.55, 0.26);
  colours->AddRGBPoint(0.75 * top, 0.82, 0.20, 0.18);
  colours->AddRGBPoint(top, 0.40, 0.02, 0.22);
  return colours;
}

/// Blue inside the target, white on it, red outside.
vtkSmartPointer<vtkColorTransferFunction> distance_colours(double largest) {
  auto colours = vtkSmartPointer<vtkColorTransferFunction>::New();
  const double top = largest > 0.0 ? largest : 1.0;
  colours->AddRGBPoint(-top, 0.10, 0.20, 0.60);
  colours->AddRGBPoint(-0.5 * top, 0.45, 0.65, 0.90);
  colours->AddRGBPoint(0.0, 0.97, 0.97, 0.97);
  colours->AddRGBPoint(0.5 * top, 0.95, 0.60, 0.45);
  colours->AddRGBPoint(top, 0.70, 0.05, 0.10);
  colours->SetNanColor(kSkin[0], kSkin[1], kSkin[2]);
  return colours;
}

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

/// A lamp from above and beside the camera, and a weak one at the camera: hollows and bulges show by their shading.
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

void add_text(const std::string& text, int size, double x, double y, bool centred, vtkRenderer* renderer) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  actor->GetTextProperty()->SetFontSize(size);
  actor->GetTextProperty()->SetColor(kInk[0], kInk[1], kInk[2]);
  if (centred) actor->GetTextProperty()->SetJustificationToCentered();
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->SetPosition(x, y);
  renderer->AddActor2D(actor);
}

vtkSmartPointer<vtkRenderer> legend_panel(vtkColorTransferFunction* colours, const char* title) {
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colours);
  bar->SetTitle(title);
  bar->SetNumberOfLabels(5);
  bar->SetLabelFormat("%.1f");
  bar->UnconstrainedFontSizeOn();
  bar->SetPosition(0.05, 0.12);
  bar->SetWidth(0.75);
  bar->SetHeight(0.74);
  bar->SetBarRatio(0.35);
  bar->SetVerticalTitleSeparation(14);
  for (vtkTextProperty* text : {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
    text->SetColor(kInk[0], kInk[1], kInk[2]);
    text->SetFontSize(22);
    text->ItalicOff();
    text->BoldOff();
    text->ShadowOff();
  }
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->SetViewport(3 * kPanelWidth, 0.06, 1.0, 1.0);
  renderer->SetBackground(1, 1, 1);
  renderer->AddActor2D(bar);
  return renderer;
}

/// One of the three views. `field` colours the surface; skin without one.
vtkSmartPointer<vtkRenderer> panel(int place, vtkPolyData* surface, const View& view, vtkColorTransferFunction* colours,
                                   const char* field) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(surface);
  mapper->SetScalarVisibility(field != nullptr);
  if (field != nullptr) {
    mapper->SetScalarModeToUsePointFieldData();
    mapper->SelectColorArray(field);
    mapper->SetLookupTable(colours);
    mapper->InterpolateScalarsBeforeMappingOff();
  }
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(kSkin[0], kSkin[1], kSkin[2]);
  actor->GetProperty()->SetInterpolationToPhong();
  actor->GetProperty()->SetAmbient(field != nullptr ? 0.3 : 0.12);
  actor->GetProperty()->SetDiffuse(field != nullptr ? 0.75 : 0.9);
  actor->GetProperty()->SetSpecular(field != nullptr ? 0.0 : 0.08);
  actor->GetProperty()->SetSpecularPower(20);
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->SetViewport(place * kPanelWidth, 0.06, (place + 1) * kPanelWidth, kTitleStrip);
  renderer->SetBackground(1, 1, 1);
  renderer->AddActor(actor);
  set_lights(renderer);
  set_camera(view, renderer);
  return renderer;
}

vtkSmartPointer<vtkRenderer> title_panel(const std::array<const char*, 3>& titles) {
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->SetViewport(0.0, kTitleStrip, 1.0, 1.0);
  renderer->SetBackground(1, 1, 1);
  for (size_t i = 0; i < titles.size(); ++i) {
    add_text(titles[i], 30, (static_cast<double>(i) + 0.5) * kPanelWidth, 0.3, true, renderer);
  }
  return renderer;
}

vtkSmartPointer<vtkRenderer> caption_panel(const std::string& caption) {
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->SetViewport(0.0, 0.0, 1.0, 0.06);
  renderer->SetBackground(1, 1, 1);
  add_text(caption, 20, 0.01, 0.3, false, renderer);
  return renderer;
}

absl::Status write_png(const std::filesystem::path& png, const std::vector<vtkSmartPointer<vtkRenderer>>& panels) {
  vtkNew<vtkRenderWindow> window;
  window->OffScreenRenderingOn();
  window->SetMultiSamples(8);
  window->SetSize(kWidth, kHeight);
  for (const auto& renderer : panels) window->AddRenderer(renderer);
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

/// Three panels of one view; the third shows `field` with a legend.
absl::Status draw(const PictureRequest& request, vtkPolyData* after, const char* field, const char* weight,
                  vtkColorTransferFunction* colours, const char* third_title, const char* legend) {
  const Surface after_shaded = with_normals(after);
  const Surface before_shaded = with_normals(at_rest(after));
  const View view = view_of(before_shaded, weight, request.up);
  return write_png(request.png,
                   {panel(0, before_shaded, view, nullptr, nullptr), panel(1, after_shaded, view, nullptr, nullptr),
                    panel(2, after_shaded, view, colours, field), legend_panel(colours, legend),
                    title_panel({"Before", "After, simulated", third_title}), caption_panel(request.caption)});
}

}  // namespace

absl::Status draw_result_picture(const PictureRequest& request) {
  const auto after = read_surface(request.mesh);
  if (!after.ok()) return after.status();
  add_displacement_length(*after);
  const auto colours = displacement_colours(largest_size(*after, kLength));
  return draw(request, *after, kLength, kDisplacement, colours, "Displacement of the skin", "mm");
}

absl::Status draw_distance_picture(const PictureRequest& request) {
  const auto after = read_surface(request.mesh);
  if (!after.ok()) return after.status();
  if ((*after)->GetPointData()->GetArray(kDistance) == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat(request.mesh.string(), " has no point field ", kDistance));
  }
  const auto colours = distance_colours(largest_size(*after, kDistance));
  return draw(request, *after, kDistance, kDisplacement, colours, "Distance to the target", "mm");
}

}  // namespace lipofill::client
