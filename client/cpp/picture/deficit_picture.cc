#include "client/cpp/picture/deficit_picture.h"

#include <vtkPointData.h>

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "client/cpp/picture/colours.h"
#include "client/cpp/picture/panels.h"
#include "client/cpp/picture/surface.h"
#include "client/cpp/picture/view.h"

namespace lipofill::client {
namespace {

using Align = Overlay::Align;

constexpr char kDistance[] = "distance_mm";
constexpr int kTitleSize = 36;
constexpr int kHeadingSize = 28;
constexpr int kTextSize = 22;
constexpr double kPanel = 0.335;
constexpr double kBar = 0.68;       // where the scale of the distance begins
constexpr double kFigures = 0.755;  // and the column of figures
constexpr double kFiguresRight = 0.985;
constexpr double kTop = 0.86;
constexpr double kLine = 0.04;
constexpr size_t kMostRemarks = 3;

void add_figures(const PictureRequest& request, Overlay& overlay) {
  double y = kTop;
  for (const auto& [what, value] : request.figures) {
    if (value.empty() && y < kTop) y -= 0.6 * kLine;
    overlay.add_text(what, value.empty() ? kHeadingSize : kTextSize, kFigures, y);
    overlay.add_text(value, kTextSize, kFiguresRight, y, Align::kRight);
    y -= value.empty() ? 1.3 * kLine : kLine;
  }
}

}  // namespace

absl::Status draw_deficit_picture(const PictureRequest& request) {
  const auto surface = read_plain_surface(request.mesh);
  if (!surface.ok()) return surface.status();
  if ((*surface)->GetPointData()->GetArray(kDistance) == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat(request.mesh.string(), " has no point field '", kDistance, "'"));
  }
  const Surface shaded = with_normals(*surface);
  const View view = view_of(shaded, kDistance, request.up);
  const auto colours = distance_colours(largest_size(shaded, kDistance));
  const size_t remarks = std::min(request.remarks.size(), kMostRemarks);
  const double bottom = 0.07 + kLine * static_cast<double>(remarks);
  Sheet sheet{2000, 900, {}, {}};
  sheet.panels = {
      panel({0.0, bottom, kPanel, kTop}, shaded, view, {}),
      panel({kPanel, bottom, 2 * kPanel, kTop}, shaded, view, {Paint::Kind::kPointField, kDistance, colours})};
  sheet.overlay.add_text(request.title, kTitleSize, 0.012, 0.96);
  sheet.overlay.add_text("The face as it is", kHeadingSize, 0.5 * kPanel, kTop + 0.03, Align::kCentre);
  sheet.overlay.add_text("Its distance from the target", kHeadingSize, 1.5 * kPanel, kTop + 0.03, Align::kCentre);
  sheet.overlay.add_text("mm", kHeadingSize, kBar, kTop);
  sheet.overlay.add_bar({kBar, 0.3, kBar + 0.02, kTop - 0.05}, colours);
  sheet.overlay.add_text("blue: missing", kTextSize, kBar, 0.25);
  sheet.overlay.add_text("red: too much", kTextSize, kBar, 0.25 - kLine);
  add_figures(request, sheet.overlay);
  for (size_t k = 0; k < remarks; ++k) {
    const double y = bottom - kLine * (static_cast<double>(k) + 0.5);
    sheet.overlay.add_text(request.remarks[k], kTextSize, 0.012, y);
  }
  sheet.overlay.add_text(request.caption, kTextSize, 0.012, 0.03);
  return write_png(request.png, sheet);
}

}  // namespace lipofill::client
