#include "client/cpp/picture/face_picture.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkContourFilter.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cpp/picture/colours.h"
#include "client/cpp/picture/panels.h"
#include "client/cpp/picture/pressure_bands.h"

namespace lipofill::client {
namespace {

constexpr char kDistanceField[] = "distance_mm";
constexpr Colour kDark = {0.05, 0.05, 0.10};
constexpr Colour kWhite = {1.0, 1.0, 1.0};

std::vector<const char*> fields_of(FacePaint paint) {
  switch (paint) {
    case FacePaint::kSkin:
      return {};
    case FacePaint::kMovement:
      return {kDisplacement};
    case FacePaint::kBands:
      return {kPressure, kThickness};
    case FacePaint::kDistance:
      return {kDistanceField};
  }
  return {};
}

/// The part of a surface that has a distance at every corner.
Surface where_compared(vtkPolyData* surface) {
  vtkDataArray* distance = surface->GetPointData()->GetArray(kDistanceField);
  auto part = Surface::New();
  part->SetPoints(surface->GetPoints());
  part->GetPointData()->AddArray(distance);
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIdList> corners;
  for (vtkIdType c = 0; c < surface->GetNumberOfCells(); ++c) {
    surface->GetCellPoints(c, corners);
    bool is_compared = true;
    for (vtkIdType k = 0; k < corners->GetNumberOfIds(); ++k) {
      is_compared = is_compared && std::isfinite(distance->GetComponent(corners->GetId(k), 0));
    }
    if (is_compared) cells->InsertNextCell(corners);
  }
  part->SetPolys(cells);
  return part;
}

/// Lines where the distance is a multiple of the step, on one side of zero.
void add_lines(vtkPolyData* surface, double step, double largest, const Colour& colour, vtkRenderer* renderer) {
  vtkNew<vtkContourFilter> lines;
  lines->SetInputData(surface);
  lines->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, kDistanceField);
  const int count = static_cast<int>(std::floor(largest / std::abs(step)));
  for (int k = 0; k < count; ++k) lines->SetValue(k, step * (k + 1));
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(lines->GetOutputPort());
  mapper->ScalarVisibilityOff();
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  mapper->SetRelativeCoincidentTopologyLineOffsetParameters(0.0, -8.0);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(2.0F);
  renderer->AddActor(actor);
}

vtkSmartPointer<vtkRenderer> paint_face(const FacePicture& picture) {
  constexpr Area kWhole{};
  const Surface shaded = with_normals(picture.surface);
  if (picture.paint == FacePaint::kSkin) return panel(kWhole, shaded, picture.view, {});
  if (picture.paint == FacePaint::kBands) {
    return panel(kWhole, in_pressure_bands(shaded), picture.view, {Paint::Kind::kCellColours});
  }
  if (picture.paint == FacePaint::kMovement) {
    add_displacement_length(shaded);
    const auto colours = displacement_colours(picture.largest);
    return panel(kWhole, shaded, picture.view, {Paint::Kind::kPointField, kDisplacementLength, colours});
  }
  const auto colours = distance_colours(picture.largest);
  auto renderer = panel(kWhole, shaded, picture.view, {Paint::Kind::kPointField, kDistanceField, colours});
  const Surface compared = where_compared(shaded);
  add_lines(compared, -picture.line_step, picture.largest, kDark, renderer);
  add_lines(compared, picture.line_step, picture.largest, kWhite, renderer);
  return renderer;
}

}  // namespace

absl::Status draw_face_picture(const FacePicture& picture) {
  for (const char* field : fields_of(picture.paint)) {
    if (picture.surface->GetPointData()->GetArray(field) == nullptr) {
      return absl::InvalidArgumentError(absl::StrCat("the surface has no point field '", field, "'"));
    }
  }
  Sheet sheet{kFacePictureWidth, kFacePictureHeight, {paint_face(picture)}, {}};
  return write_png(picture.png, sheet);
}

}  // namespace lipofill::client
