#include "client/cpp/picture/result_picture.h"

#include <string_view>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "client/cpp/picture/colours.h"
#include "client/cpp/picture/panels.h"
#include "client/cpp/picture/pressure_bands.h"
#include "client/cpp/picture/surface.h"
#include "client/cpp/picture/view.h"

namespace lipofill::client {
namespace {

using Align = Overlay::Align;
using Kind = Paint::Kind;

constexpr char kDistance[] = "distance_mm";
constexpr int kTitleSize = 36;
constexpr int kHeadingSize = 28;
constexpr int kTextSize = 22;

// The sheet of a result: two columns and two rows of panels, a column of legends and figures.
constexpr double kColumn = 0.385;
constexpr double kSide = 0.785;       // where the third column begins
constexpr double kSideRight = 0.985;  // and where its figures end
constexpr double kRowsTop = 0.945;
constexpr double kRowsBottom = 0.045;
constexpr double kRemarkLine = 0.019;
constexpr size_t kMostRemarks = 6;
constexpr size_t kLineLength = 125;  // letters that fit below the two columns of panels
constexpr double kHeading = 0.032;   // of a row, above its panels
constexpr double kLine = 0.027;      // from a line of text to the next

/// The two rows of panels: they leave room for remarks below them.
struct Rows {
  double bottom = kRowsBottom;

  /// The panel in a column and a row, both from the upper left.
  Area area_of(int column, int row) const {
    const double height = 0.5 * (kRowsTop - bottom);
    const double low = bottom + (1 - row) * height;
    return {column * kColumn, low, (column + 1) * kColumn, low + height - kHeading};
  }
};

/// Adds a remark in lines that fit the sheet, broken between words.
void add_lines(std::string_view remark, std::vector<std::string>& lines) {
  while (remark.size() > kLineLength) {
    const size_t space = remark.rfind(' ', kLineLength);
    const size_t end = space == std::string_view::npos || space == 0 ? kLineLength : space;
    lines.emplace_back(remark.substr(0, end));
    remark.remove_prefix(end + (end == space ? 1 : 0));
  }
  lines.emplace_back(remark);
}

/// The remarks as lines that fit the sheet.
std::vector<std::string> lines_of(const std::vector<std::string>& remarks) {
  std::vector<std::string> lines;
  for (size_t k = 0; k < remarks.size() && k < kMostRemarks; ++k) add_lines(remarks[k], lines);
  if (remarks.size() > kMostRemarks) lines.push_back(absl::StrCat("and ", remarks.size() - kMostRemarks, " more"));
  return lines;
}

void add_remarks(const std::vector<std::string>& lines, Overlay& overlay) {
  double y = kRowsBottom + kRemarkLine * (static_cast<double>(lines.size()) - 0.5);
  for (const std::string& line : lines) {
    overlay.add_text(line, kTextSize, 0.012, y);
    y -= kRemarkLine;
  }
}

void add_heading(const std::string& text, const Area& area, Overlay& overlay) {
  overlay.add_text(text, kHeadingSize, 0.5 * (area.left + area.right), area.top + 0.5 * kHeading, Align::kCentre);
}

void add_pressure_legend(double top, Overlay& overlay) {
  overlay.add_text("Pressure of the fat", kHeadingSize, kSide, top);
  double y = top;
  for (const PressureBand& band : kPressureBands) {
    y -= 1.2 * kLine;
    overlay.add_box({kSide, y - 0.4 * kLine, kSide + 0.02, y + 0.4 * kLine}, band.colour);
    overlay.add_text(band.label, kTextSize, kSide + 0.027, y);
  }
  overlay.add_text("white: no fat below", kTextSize, kSide, y - 1.2 * kLine);
}

void add_figures(const PictureRequest& request, double top, Overlay& overlay) {
  double y = top;
  for (const auto& [what, value] : request.figures) {
    const bool is_heading = value.empty();
    if (is_heading && y < top) y -= 0.6 * kLine;
    overlay.add_text(what, is_heading ? kHeadingSize : kTextSize, kSide, y);
    overlay.add_text(value, kTextSize, kSideRight, y, Align::kRight);
    y -= is_heading ? 1.3 * kLine : kLine;
  }
}

Sheet result_sheet(const PictureRequest& request, vtkPolyData* after) {
  const Surface shaded = with_normals(after);
  const Surface before = with_normals(at_rest(after));
  const View view = view_of(before, kDisplacement, request.up);
  const auto colours = displacement_colours(largest_size(after, kDisplacementLength));
  const std::vector<std::string> remarks = lines_of(request.remarks);
  const Rows rows{kRowsBottom + kRemarkLine * static_cast<double>(remarks.size())};
  const auto area_of = [&rows](int column, int row) { return rows.area_of(column, row); };
  Sheet sheet{2000, 1480, {}, {}};
  sheet.panels = {panel(area_of(0, 0), before, view, {}), panel(area_of(1, 0), shaded, view, {}),
                  panel(area_of(0, 1), shaded, view, {Kind::kPointField, kDisplacementLength, colours}),
                  panel(area_of(1, 1), in_pressure_bands(shaded), view, {Kind::kCellColours})};
  add_heading("Before", area_of(0, 0), sheet.overlay);
  add_heading("After, simulated", area_of(1, 0), sheet.overlay);
  add_heading("Displacement of the skin", area_of(0, 1), sheet.overlay);
  add_heading("Pressure of the fat", area_of(1, 1), sheet.overlay);
  sheet.overlay.add_text(request.title, kTitleSize, 0.012, 0.972);
  sheet.overlay.add_text(request.caption, kTextSize, 0.012, 0.018);
  add_remarks(remarks, sheet.overlay);
  add_figures(request, area_of(0, 0).top, sheet.overlay);
  const double legends = area_of(0, 1).top;
  sheet.overlay.add_text("Displacement [mm]", kHeadingSize, kSide, legends);
  sheet.overlay.add_bar({kSide, legends - 0.2, kSide + 0.02, legends - 0.03}, colours);
  add_pressure_legend(legends - 0.245, sheet.overlay);
  return sheet;
}

/// Three panels in a row, the third with the distance.
Sheet distance_sheet(const PictureRequest& request, vtkPolyData* after) {
  constexpr double kPanel = 0.31;
  const Surface shaded = with_normals(after);
  const Surface before = with_normals(at_rest(after));
  const View view = view_of(before, kDisplacement, request.up);
  const auto colours = distance_colours(largest_size(after, kDistance));
  const auto area = [](int place) { return Area{place * kPanel, 0.06, (place + 1) * kPanel, 0.9}; };
  Sheet sheet{2100, 800, {}, {}};
  sheet.panels = {panel(area(0), before, view, {}), panel(area(1), shaded, view, {}),
                  panel(area(2), shaded, view, {Kind::kPointField, kDistance, colours})};
  add_heading("Before", area(0), sheet.overlay);
  add_heading("After, simulated", area(1), sheet.overlay);
  add_heading("Distance to the target", area(2), sheet.overlay);
  sheet.overlay.add_text("mm", kHeadingSize, 3 * kPanel + 0.01, 0.88);
  sheet.overlay.add_bar({3 * kPanel + 0.01, 0.15, 3 * kPanel + 0.03, 0.83}, colours);
  sheet.overlay.add_text(request.caption, kTextSize, 0.01, 0.03);
  return sheet;
}

}  // namespace

absl::Status draw_result_picture(const PictureRequest& request) {
  const auto after = read_surface(request.mesh, {kPressure, kThickness});
  if (!after.ok()) return after.status();
  add_displacement_length(*after);
  return write_png(request.png, result_sheet(request, *after));
}

absl::Status draw_distance_picture(const PictureRequest& request) {
  const auto after = read_surface(request.mesh, {kDistance});
  if (!after.ok()) return after.status();
  return write_png(request.png, distance_sheet(request, *after));
}

}  // namespace lipofill::client
