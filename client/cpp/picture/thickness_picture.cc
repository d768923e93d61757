#include "client/cpp/picture/thickness_picture.h"

#include <vtkColorTransferFunction.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/cpp/picture/panels.h"
#include "client/cpp/picture/surface.h"

namespace lipofill::client {
namespace {

using Align = Overlay::Align;

constexpr int kTitleSize = 34;
constexpr int kHeadingSize = 28;
constexpr int kTextSize = 20;
constexpr int kPanelWidth = 700;
constexpr int kHeight = 900;
constexpr double kTop = 0.80;
constexpr double kLine = 0.032;
constexpr size_t kMostRemarks = 4;
/// The grey of what was not measured is no colour of the scale.
constexpr Colour kDefault = {0.62, 0.62, 0.64};

/// Thickness from the least to the most: light to dark, so that it reads without colour too.
vtkSmartPointer<vtkColorTransferFunction> thickness_colours(double least, double most) {
  const double span = std::max(most - least, 0.1);
  auto colours = vtkSmartPointer<vtkColorTransferFunction>::New();
  colours->SetColorSpaceToLab();
  colours->AddRGBPoint(least, 0.99, 0.91, 0.62);
  colours->AddRGBPoint(least + span / 3.0, 0.42, 0.78, 0.56);
  colours->AddRGBPoint(least + 2.0 * span / 3.0, 0.15, 0.48, 0.56);
  colours->AddRGBPoint(least + span, 0.20, 0.12, 0.36);
  colours->SetNanColor(kDefault[0], kDefault[1], kDefault[2]);
  return colours;
}

/// The least and the greatest finite value of a field; 0 and 1 without any.
std::array<double, 2> range_of(vtkDataArray* values) {
  std::array<double, 2> range = {HUGE_VAL, -HUGE_VAL};
  for (vtkIdType k = 0; k < values->GetNumberOfTuples(); ++k) {
    const double value = values->GetComponent(k, 0);
    if (!std::isfinite(value)) continue;
    range = {std::min(range[0], value), std::max(range[1], value)};
  }
  return range[0] <= range[1] ? range : std::array<double, 2>{0.0, 1.0};
}

}  // namespace

absl::Status draw_thickness_picture(const ThicknessPicture& picture) {
  const auto surface = read_plain_surface(picture.mesh);
  if (!surface.ok()) return surface.status();
  const Surface shaded = with_normals(*surface);
  const View view = view_of(shaded, "", picture.up);
  const size_t count = std::min(picture.maps.size(), kMostThicknessMaps);
  const size_t remarks = std::min(picture.remarks.size(), kMostRemarks);
  const double bottom = 0.08 + kLine * static_cast<double>(remarks);
  const double width = 1.0 / static_cast<double>(std::max<size_t>(count, 2));
  Sheet sheet{kPanelWidth * static_cast<int>(std::max<size_t>(count, 2)), kHeight, {}, {}};
  for (size_t k = 0; k < count; ++k) {
    const ThicknessMap& map = picture.maps[k];
    vtkDataArray* const values = shaded->GetPointData()->GetArray(map.field.c_str());
    if (values == nullptr)
      return absl::InvalidArgumentError(absl::StrCat(picture.mesh.string(), " has no point field '", map.field, "'"));
    const auto range = range_of(values);
    const auto colours = thickness_colours(range[0], range[1]);
    const double left = width * static_cast<double>(k), bar = left + 0.86 * width;
    sheet.panels.push_back(
        panel({left, bottom, bar - 0.01, kTop}, shaded, view, {Paint::Kind::kPointField, map.field.c_str(), colours}));
    sheet.overlay.add_text(map.heading, kHeadingSize, left + 0.02 * width + 0.01, kTop + 0.075);
    sheet.overlay.add_text(map.figures, kTextSize, left + 0.02 * width + 0.01, kTop + 0.03);
    sheet.overlay.add_text("mm", kTextSize, bar, kTop - 0.01);
    sheet.overlay.add_bar({bar, bottom + 0.08, bar + 0.03 * width, kTop - 0.05}, colours);
  }
  sheet.overlay.add_text(picture.title, kTitleSize, 0.012, 0.95);
  for (size_t k = 0; k < remarks; ++k)
    sheet.overlay.add_text(picture.remarks[k], kTextSize, 0.012, bottom - kLine * (static_cast<double>(k) + 0.5));
  sheet.overlay.add_text(absl::StrCat("Grey: not measured, the default stands.  ", picture.caption), kTextSize, 0.012,
                         0.025);
  return write_png(picture.png, sheet);
}

}  // namespace lipofill::client
