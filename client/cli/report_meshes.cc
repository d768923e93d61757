#include "client/cli/report_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <vector>

#include "client/cli/distance_fields.h"
#include "client/cpp/io/mesh_files.h"

namespace lipofill::client {
namespace {

using Point3 = std::array<double, 3>;

/// The middle of points that lie far from the origin; none for others.
std::optional<Point3> far_centre_of(const Array& points) {
  if (points.type != ElementType::kFloat64) return std::nullopt;
  Point3 low;
  Point3 high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  const auto values = points.doubles();
  for (size_t k = 0; k < values.size(); ++k) {
    low[k % 3] = std::min(low[k % 3], values[k]);
    high[k % 3] = std::max(high[k % 3], values[k]);
  }
  return Point3{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2])};
}

Array moved_by(const Array& points, const Point3& offset) {
  Array moved = points;
  moved.type = ElementType::kFloat32;
  const std::vector<double> values = points.to_doubles();
  std::vector<float> near(values.size());
  for (size_t k = 0; k < values.size(); ++k) near[k] = static_cast<float>(values[k] - offset[k % 3]);
  moved.bytes.resize(near.size() * sizeof(float));
  std::memcpy(moved.bytes.data(), near.data(), moved.bytes.size());
  return moved;
}

/// Writes surfaces, all moved alike.
class SurfaceWriter {
 public:
  SurfaceWriter(std::filesystem::path folder, std::optional<Point3> offset)
      : folder_(std::move(folder)), offset_(offset) {}

  /// @param more  a field beside those that are given; may be null
  absl::Status write(const char* name, const std::vector<Array>& meshes, const std::vector<Array>& fields,
                     const Array* more) const {
    auto views = mesh_views(meshes, fields);
    if (!views.ok()) return views.status();
    if (views->size() != 1) return absl::DataLossError("the daemon sent another number of meshes than one");
    MeshView& view = views->front();
    if (more != nullptr) view.fields.push_back(more);
    Array moved;
    if (offset_) {
      moved = moved_by(*view.points, *offset_);
      view.points = &moved;
    }
    return write_mesh(folder_ / name, view);
  }

 private:
  std::filesystem::path folder_;
  std::optional<Point3> offset_;
};

double largest_length(const std::vector<Array>& fields) {
  double largest = 0.0;
  for (const Array& field : fields) {
    if (field.field() != "displacement") continue;
    const auto values = field.floats();
    for (size_t k = 0; k + 2 < values.size(); k += 3) {
      largest = std::max<double>(largest, std::hypot(values[k], values[k + 1], values[k + 2]));
    }
  }
  return largest;
}

double largest_size(const Array& field) {
  double largest = 0.0;
  for (const float value : field.floats()) {
    if (std::isfinite(value)) largest = std::max<double>(largest, std::abs(value));
  }
  return largest;
}

/// An end for a scale: the next half millimetre, or tenth where all is small.
double rounded_up(double largest) {
  const double step = largest > 0.5 ? 0.5 : 0.1;
  return std::max(step, step * std::ceil(largest / step));
}

double line_step(double largest) {
  if (largest <= 2.0) return 0.5;
  return largest <= 8.0 ? 1.0 : 2.0;
}

std::optional<Point3> landmark_centre(const v1::ScanRegion& region, const std::optional<Point3>& offset) {
  if (region.landmarks_mm().empty()) return std::nullopt;
  std::array<Point3, 2> box;
  box[0].fill(std::numeric_limits<double>::infinity());
  box[1].fill(-std::numeric_limits<double>::infinity());
  for (const auto& [name, place] : region.landmarks_mm()) {
    const Point3 point = {place.x(), place.y(), place.z()};
    for (size_t i = 0; i < 3; ++i) {
      box[0][i] = std::min(box[0][i], point[i]);
      box[1][i] = std::max(box[1][i], point[i]);
    }
  }
  Point3 centre;
  for (size_t i = 0; i < 3; ++i) centre[i] = 0.5 * (box[0][i] + box[1][i]) - (offset ? (*offset)[i] : 0.0);
  return centre;
}

/// The shape with its distances from the target; 0 where there is no target.
absl::StatusOr<double> write_distances(const SurfaceWriter& writer, const char* name, const FinalState& state,
                                       const v1::Evaluation& evaluation) {
  const Array* displacement = find_array(state.frame.fields, evaluation.mesh() + ".displacement");
  if (displacement == nullptr) return absl::DataLossError("the daemon sent no displacement");
  const auto distance = distance_field(evaluation, displacement->rows());
  if (!distance.ok()) return distance.status();
  const auto written = writer.write(name, state.meshes.arrays, {*displacement}, &*distance);
  if (!written.ok()) return written;
  return largest_size(*distance);
}

/// Writes what a target has to show, and the largest distance in it.
absl::StatusOr<double> write_target(const ReportFetch& fetch, const SurfaceWriter& writer) {
  const ReportAnswers& answers = fetch.answers();
  double largest = 0.0;
  if (auto written = writer.write("target.vtp", fetch.target_mesh(), {}, nullptr); !written.ok()) return written;
  if (answers.deficit) {
    const Array distance = distance_field(*answers.deficit);
    if (auto written = writer.write("deficit.vtp", fetch.scan_mesh(), {}, &distance); !written.ok()) return written;
    largest = largest_size(distance);
  }
  const auto planned = write_distances(writer, "planned-distance.vtp", fetch.planned(), *answers.planned.evaluation);
  if (!planned.ok()) return planned;
  const auto remaining =
      write_distances(writer, "remaining-distance.vtp", fetch.remaining(), *answers.remaining.evaluation);
  if (!remaining.ok()) return remaining;
  return std::max({largest, *planned, *remaining});
}

}  // namespace

absl::StatusOr<WrittenMeshes> write_report_meshes(const ReportFetch& fetch, const std::filesystem::path& folder) {
  const std::vector<Array>& meshes = fetch.planned().meshes.arrays;
  const auto points =
      std::find_if(meshes.begin(), meshes.end(), [](const Array& array) { return array.field() == "points"; });
  if (points == meshes.end()) return absl::DataLossError("the daemon sent no points");
  const std::optional<Point3> offset = far_centre_of(*points);
  const SurfaceWriter writer(folder, offset);
  absl::Status written = writer.write("before.vtp", meshes, {}, nullptr);
  if (written.ok()) written = writer.write("planned.vtp", meshes, fetch.planned().frame.fields, nullptr);
  if (written.ok()) {
    written = writer.write("remaining.vtp", fetch.remaining().meshes.arrays, fetch.remaining().frame.fields, nullptr);
  }
  if (!written.ok()) return written;
  WrittenMeshes result;
  result.centre = landmark_centre(fetch.answers().model.spec().scan_region(), offset);
  result.scales.displacement_mm = rounded_up(largest_length(fetch.planned().frame.fields));
  if (!fetch.answers().target) return result;
  const auto largest = write_target(fetch, writer);
  if (!largest.ok()) return largest.status();
  result.scales.distance_mm = rounded_up(*largest);
  result.scales.line_mm = line_step(*largest);
  return result;
}

}  // namespace lipofill::client
