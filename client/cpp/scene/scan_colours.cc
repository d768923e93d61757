#include "client/cpp/scene/scan_colours.h"

#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkStaticPointLocator.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "client/cpp/gltf/gltf_surface.h"
#include "client/cpp/scene/ply_colours.h"

namespace lipofill::client {
namespace {

constexpr double kNearMm = 1.0;
constexpr double kMostWithout = 0.05;
/// Colour of a point without one.
const Eigen::Vector3f kWithout(0.87F, 0.70F, 0.60F);

/// @param brightest  the colour value that stands for 1
ColouredPoints coloured_points(const std::vector<PlyVertex>& vertices, double mm, double brightest) {
  ColouredPoints found;
  const auto count = static_cast<Eigen::Index>(vertices.size());
  found.points_mm.resize(3, count);
  found.colours.resize(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const PlyVertex& vertex = vertices[static_cast<size_t>(k)];
    for (int c = 0; c < 3; ++c) {
      found.points_mm(c, k) = mm * vertex[static_cast<size_t>(c)];
      found.colours(c, k) = static_cast<float>(vertex[static_cast<size_t>(c + 3)] / brightest);
    }
  }
  return found;
}

absl::StatusOr<ColouredPoints> read_ply(const std::filesystem::path& file, double mm) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  const auto vertices = read_ply_colours(bytes);
  if (!vertices.ok()) return vertices.status();
  return coloured_points(*vertices, mm, 255.0);
}

/// "v x y z r g b", from 0 to 1 or, as some programs write them, to 255.
absl::StatusOr<ColouredPoints> read_obj(const std::filesystem::path& file, double mm) {
  std::ifstream stream(file);
  std::vector<PlyVertex> vertices;
  std::string line;
  while (std::getline(stream, line)) {
    const std::vector<std::string> words = absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.size() != 7 || words[0] != "v") continue;
    PlyVertex vertex{};
    bool good = true;
    for (size_t k = 0; k < vertex.size(); ++k) good = absl::SimpleAtod(words[k + 1], &vertex[k]) && good;
    if (good) vertices.push_back(vertex);
  }
  if (vertices.empty()) return absl::InvalidArgumentError("has no colours behind its vertices (v x y z r g b)");
  // As the daemon reads them: a few that are too bright must not darken the others.
  const auto above = std::count_if(vertices.begin(), vertices.end(), [](const auto& vertex) {
    return std::max({vertex[3], vertex[4], vertex[5]}) > 2.0;
  });
  return coloured_points(vertices, mm, 100 * static_cast<size_t>(above) > vertices.size() ? 255.0 : 1.0);
}

absl::StatusOr<ColouredPoints> read_gltf(const std::filesystem::path& file, double mm) {
  const auto surface = read_gltf_surface(file);
  if (!surface.ok()) return surface.status();
  if (surface->colours.empty()) return absl::InvalidArgumentError("has no colours of its vertices (COLOR_0)");
  const double unit = gltf_unit_mm(*surface, mm);
  ColouredPoints found;
  const auto count = static_cast<Eigen::Index>(surface->points.size());
  found.points_mm.resize(3, count);
  found.colours.resize(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (int c = 0; c < 3; ++c) {
      found.points_mm(c, k) = unit * surface->points[static_cast<size_t>(k)][static_cast<size_t>(c)];
      found.colours(c, k) =
          static_cast<float>(surface->colours[static_cast<size_t>(k)][static_cast<size_t>(c)] / 255.0);
    }
  }
  return found;
}

}  // namespace

absl::StatusOr<ColouredPoints> read_scan_colours(const std::filesystem::path& file, double mm) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    return absl::InvalidArgumentError(absl::StrCat("scan file ", file.string(), " does not exist or is not a file"));
  const std::string ending = absl::AsciiStrToLower(file.extension().string());
  absl::StatusOr<ColouredPoints> found = absl::InvalidArgumentError("is not one of .ply, .obj, .glb, .gltf");
  if (ending == ".ply") found = read_ply(file, mm);
  if (ending == ".obj") found = read_obj(file, mm);
  if (is_gltf_name(file)) found = read_gltf(file, mm);
  if (!found.ok())
    return absl::InvalidArgumentError(absl::StrCat("scan file ", file.string(), ": ", found.status().message()));
  return found;
}

absl::StatusOr<Eigen::Matrix3Xf> find_nearest_colours(const ColouredPoints& scan, const Eigen::Matrix3Xd& points_mm) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(scan.points_mm.cols());
  for (Eigen::Index k = 0; k < scan.points_mm.cols(); ++k) points->SetPoint(k, scan.points_mm.col(k).data());
  vtkNew<vtkPolyData> cloud;
  cloud->SetPoints(points);
  vtkNew<vtkStaticPointLocator> locator;
  locator->SetDataSet(cloud);
  locator->BuildLocator();
  Eigen::Matrix3Xf colours(3, points_mm.cols());
  Eigen::Index without = 0;
  for (Eigen::Index k = 0; k < points_mm.cols(); ++k) {
    double squared = 0.0;
    const vtkIdType nearest = locator->FindClosestPointWithinRadius(kNearMm, points_mm.col(k).data(), squared);
    if (nearest >= 0) {
      colours.col(k) = scan.colours.col(nearest);
    } else {
      colours.col(k) = kWithout;
      ++without;
    }
  }
  if (static_cast<double>(without) > kMostWithout * static_cast<double>(points_mm.cols())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d of %d points of the skin have no coloured point within %g mm: the colours are of another "
                        "scan, or in another unit (--unit)",
                        without, points_mm.cols(), kNearMm));
  }
  return colours;
}

}  // namespace lipofill::client
