#include "core/geometry/surface_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/geometry/polygon_triangulation.h"

namespace lipofill::geometry {
namespace {

constexpr size_t kMostPlacesKept = 1000;
/// Cutting takes the square of a polygon's corners; all together may take some seconds.
constexpr double kMostCuttingWork = 2e9;
constexpr float kNoColour = std::numeric_limits<float>::quiet_NaN();
constexpr Rgb8 kSkinColour = {222, 179, 153};

bool has_colour(const std::array<float, 3>& rgb) {
  return std::all_of(rgb.begin(), rgb.end(), [](float value) { return std::isfinite(value); });
}

/// The brightest number of colours that do not say it.
double guess_brightest(const std::vector<std::array<float, 3>>& colours) {
  const auto above = std::count_if(colours.begin(), colours.end(), [](const auto& rgb) {
    return has_colour(rgb) && *std::max_element(rgb.begin(), rgb.end()) > 2.0F;
  });
  return 100 * static_cast<size_t>(above) > colours.size() ? 255.0 : 1.0;
}

Rgb8 to_rgb8(const std::array<float, 3>& rgb, double brightest) {
  Rgb8 shown{};
  for (size_t c = 0; c < 3; ++c) {
    shown[c] = static_cast<uint8_t>(std::lround(255.0 * std::clamp(rgb[c] / brightest, 0.0, 1.0)));
  }
  return shown;
}

}  // namespace

std::string count_of(size_t n, const char* singular, const char* plural) {
  return absl::StrCat(n, " ", n == 1 ? singular : plural);
}

absl::Status SurfaceBuilder::add_vertex(const std::array<double, 3>& xyz, const std::string& where) {
  if (n_vertices() >= limits_.max_vertices) {
    return absl::InvalidArgumentError(
        absl::StrCat(where, ": more than ", limits_.max_vertices, " vertices, the most accepted"));
  }
  const bool is_finite = std::all_of(xyz.begin(), xyz.end(), [](double x) { return std::isfinite(x); });
  if (!is_finite && not_finite_.size() < kMostPlacesKept) {
    not_finite_.emplace_back(static_cast<size_t>(n_vertices()), where);
  }
  coordinates_.insert(coordinates_.end(), xyz.begin(), xyz.end());
  return absl::OkStatus();
}

void SurfaceBuilder::add_colour(const std::array<double, 3>& rgb) {
  colours_.resize(static_cast<size_t>(n_vertices()), {kNoColour, kNoColour, kNoColour});
  for (size_t c = 0; c < 3; ++c) colours_.back()[c] = static_cast<float>(rgb[c]);
}

absl::Status SurfaceBuilder::add_polygon(const std::vector<long long>& corners, const std::string& where) {
  for (const long long corner : corners) {
    if (corner < 0 || corner >= std::numeric_limits<int>::max()) {
      return absl::InvalidArgumentError(
          absl::StrCat(where, ": a face names vertex ", corner, " counted from 0, must be in [0, ", n_vertices(), ")"));
    }
  }
  if (corners.size() < 3) {
    ++short_faces_;
    return absl::OkStatus();
  }
  if (triangles_.size() + corners.size() - 2 > static_cast<size_t>(limits_.max_triangles)) {
    return absl::InvalidArgumentError(
        absl::StrCat(where, ": more than ", limits_.max_triangles, " triangles, the most accepted"));
  }
  if (corners.size() > 3) fans_.push_back({triangles_.size(), corners.size()});
  for (size_t k = 2; k < corners.size(); ++k) {
    triangles_.push_back(
        {static_cast<int>(corners[0]), static_cast<int>(corners[k - 1]), static_cast<int>(corners[k])});
  }
  return absl::OkStatus();
}

absl::Status SurfaceBuilder::check_corners() const {
  for (size_t t = 0; t < triangles_.size(); ++t) {
    for (const int corner : triangles_[t]) {
      if (corner < n_vertices()) continue;
      return absl::InvalidArgumentError(absl::StrCat("triangle ", t, " of the file names vertex ", corner,
                                                     " counted from 0, must be in [0, ", n_vertices(), ")"));
    }
  }
  return absl::OkStatus();
}

std::vector<bool> SurfaceBuilder::find_used() const {
  std::vector<bool> used(static_cast<size_t>(n_vertices()), false);
  for (const auto& triangle : triangles_) {
    for (const int corner : triangle) used[static_cast<size_t>(corner)] = true;
  }
  return used;
}

absl::Status SurfaceBuilder::check_used_vertices(const std::vector<bool>& used) const {
  for (size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const auto* const xyz = &coordinates_[3 * v];
    const auto* const bad = std::find_if(xyz, xyz + 3, [](double x) { return !std::isfinite(x); });
    if (bad == xyz + 3) continue;
    const auto place =
        std::find_if(not_finite_.begin(), not_finite_.end(), [v](const auto& entry) { return entry.first == v; });
    return absl::InvalidArgumentError(
        absl::StrCat(place == not_finite_.end() ? absl::StrCat("vertex ", v, " counted from 0") : place->second,
                     ": a face has a corner at this vertex, whose coordinate ", *bad, " is not a finite number"));
  }
  return absl::OkStatus();
}

absl::Status SurfaceBuilder::cut_polygons(const SurfaceMesh& vertices) {
  std::vector<int> corners;
  std::vector<std::array<int, 3>> cut;
  double work = 0.0;
  size_t crossing = 0;
  for (const Fan& fan : fans_) {
    work += static_cast<double>(fan.corners) * static_cast<double>(fan.corners);
    if (work > kMostCuttingWork) {
      return absl::InvalidArgumentError(
          absl::StrCat("the file has a face of ", fan.corners,
                       " corners, and the squares of the corners of its faces add up to more than ", kMostCuttingWork,
                       ", the most accepted: save it as triangles"));
    }
    const auto first = triangles_.begin() + static_cast<std::ptrdiff_t>(fan.first_triangle);
    corners.assign({(*first)[0], (*first)[1]});
    for (size_t k = 0; k + 2 < fan.corners; ++k) corners.push_back(first[static_cast<std::ptrdiff_t>(k)][2]);
    if (triangulate_polygon(corners, vertices.points, cut) == PolygonCut::kCrossing) ++crossing;
    std::copy(cut.begin(), cut.end(), first);
  }
  if (crossing > 0) {
    add_remark(absl::StrCat(count_of(crossing, "face crosses itself and was", "faces cross themselves and were"),
                            " cut into triangles as well as that goes."));
  }
  return absl::OkStatus();
}

void SurfaceBuilder::take_colours(const std::vector<bool>& used, ScannedSurface& mesh) {
  if (colours_.empty()) return;
  colours_.resize(used.size(), {kNoColour, kNoColour, kNoColour});
  const double brightest = brightest_ > 0.0 ? brightest_ : guess_brightest(colours_);
  mesh.colours.reserve(colours_.size());
  size_t without = 0;
  for (size_t v = 0; v < colours_.size(); ++v) {
    const bool is_coloured = has_colour(colours_[v]);
    if (used[v] && !is_coloured) ++without;
    mesh.colours.push_back(is_coloured ? to_rgb8(colours_[v], brightest) : kSkinColour);
  }
  if (without > 0) {
    add_remark(absl::StrCat(count_of(without, "vertex has", "vertices have"),
                            " no colour where others have one, and got the colour of skin."));
  }
}

void SurfaceBuilder::leave_out_unused(const std::vector<bool>& used, ScannedSurface& mesh) {
  const auto unused = static_cast<size_t>(std::count(used.begin(), used.end(), false));
  if (unused == 0) return;
  std::vector<int> renumbered(used.size(), -1);
  int kept = 0;
  for (size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    mesh.points.col(kept) = mesh.points.col(static_cast<Eigen::Index>(v));
    if (!mesh.colours.empty()) mesh.colours[static_cast<size_t>(kept)] = mesh.colours[v];
    renumbered[v] = kept++;
  }
  mesh.points.conservativeResize(3, kept);
  if (!mesh.colours.empty()) mesh.colours.resize(static_cast<size_t>(kept));
  for (auto& triangle : mesh.triangles) {
    for (int& corner : triangle) corner = renumbered[static_cast<size_t>(corner)];
  }
  add_remark(absl::StrCat(count_of(unused, "vertex", "vertices"), " of no face left out."));
}

absl::StatusOr<ScannedSurface> SurfaceBuilder::build() && {
  if (triangles_.empty()) {
    const std::string shorts =
        short_faces_ == 0 ? "no face"
                          : absl::StrCat("only ", count_of(short_faces_, "face", "faces"), " of fewer than 3 corners");
    return absl::InvalidArgumentError(
        absl::StrCat("the file has ", n_vertices(), " vertices and ", shorts, "; a surface needs at least one",
                     n_vertices() > 2 ? ": a cloud of points must be made a surface first" : ""));
  }
  if (short_faces_ > 0) {
    add_remark(absl::StrCat(count_of(short_faces_, "face", "faces"), " of fewer than three corners left out."));
  }
  absl::Status status = check_corners();
  if (!status.ok()) return status;
  const std::vector<bool> used = find_used();
  if (status = check_used_vertices(used); !status.ok()) return status;
  ScannedSurface mesh;
  mesh.points = Eigen::Map<const Eigen::Matrix3Xd>(coordinates_.data(), 3, n_vertices());
  if (status = cut_polygons(mesh); !status.ok()) return status;
  mesh.triangles = std::move(triangles_);
  take_colours(used, mesh);
  leave_out_unused(used, mesh);
  mesh.remarks = std::move(remarks_);
  return mesh;
}

}  // namespace lipofill::geometry
