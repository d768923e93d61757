#include "server/backend/evaluation.h"

#include "absl/strings/str_cat.h"
#include "core/base/units.h"
#include "core/geometry/surface_distance.h"
#include "server/backend/slice_arrays.h"
#include "server/wire/report_conversion.h"
#include "server/wire/target_conversion.h"

namespace lipofill::server {
namespace {

/// Eight bytes a vertex must stay well below the 4 MiB of a message.
constexpr size_t kMaxPatchVertices = 400'000;

Eigen::Vector3d vector_at(const std::vector<float>& values, size_t i) {
  return kMetresPerMillimetre * Eigen::Vector3d(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
}

/// Points of the patch, undisplaced and displaced, in the order of `vertices`.
void place_points(SkinPatch& patch, const std::vector<Eigen::Vector3d>& rest, const std::vector<float>& displacement) {
  const auto n = static_cast<Eigen::Index>(patch.vertices.size());
  patch.before.points.resize(3, n);
  patch.after.points.resize(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    patch.before.points.col(i) = rest[static_cast<size_t>(i)];
    patch.after.points.col(i) = rest[static_cast<size_t>(i)] + vector_at(displacement, patch.vertices[i]);
  }
}

absl::StatusOr<SkinPatch> make_scan_patch(const model::FaceModel& model, const v1::FrameSlice& frame) {
  const geometry::SurfaceMesh& scan = model.geometry.scan;
  const auto displacement = read_array<float>(frame.fields(), "scan.displacement");
  if (!displacement.ok()) return displacement.status();
  if (displacement->size() != 3 * static_cast<size_t>(scan.n_vertices())) {
    return absl::DataLossError("the result does not fit the model's scan");
  }
  SkinPatch patch;
  patch.mesh = "scan";
  std::vector<int> place(static_cast<size_t>(scan.n_vertices()), -1);
  std::vector<Eigen::Vector3d> rest;
  for (const geometry::Rider& rider : model.geometry.riders) {
    place[rider.vertex] = static_cast<int>(patch.vertices.size());
    patch.vertices.push_back(static_cast<uint32_t>(rider.vertex));
    rest.push_back(scan.points.col(rider.vertex));
  }
  for (const auto& t : scan.triangles) {
    if (place[t[0]] < 0 || place[t[1]] < 0 || place[t[2]] < 0) continue;
    patch.before.triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
  }
  patch.after.triangles = patch.before.triangles;
  place_points(patch, rest, *displacement);
  return patch;
}

absl::StatusOr<SkinPatch> make_square_patch(const v1::MeshSlice& meshes, const v1::FrameSlice& frame) {
  const auto points = read_array<float>(meshes.arrays(), "skin.points");
  const auto cells = read_array<uint32_t>(meshes.arrays(), "skin.cells");
  const auto displacement = read_array<float>(frame.fields(), "skin.displacement");
  if (!points.ok()) return points.status();
  if (!cells.ok()) return cells.status();
  if (!displacement.ok()) return displacement.status();
  if (points->size() != displacement->size()) return absl::DataLossError("the result does not fit the model's skin");
  SkinPatch patch;
  patch.mesh = "skin";
  std::vector<Eigen::Vector3d> rest;
  for (size_t i = 0; i < points->size() / 3; ++i) {
    patch.vertices.push_back(static_cast<uint32_t>(i));
    rest.push_back(vector_at(*points, i));
  }
  for (size_t c = 0; c + 3 < cells->size(); c += 4) {
    const auto corner = [&](size_t k) { return static_cast<int>((*cells)[c + k]); };
    patch.before.triangles.push_back({corner(0), corner(1), corner(2)});
    patch.before.triangles.push_back({corner(0), corner(2), corner(3)});
  }
  patch.after.triangles = patch.before.triangles;
  place_points(patch, rest, *displacement);
  return patch;
}

}  // namespace

absl::StatusOr<SkinPatch> make_skin_patch(const model::FaceModel& model, const v1::MeshSlice& meshes,
                                          const v1::FrameSlice& frame) {
  return model.is_square ? make_square_patch(meshes, frame) : make_scan_patch(model, frame);
}

absl::StatusOr<v1::Evaluation> evaluate(const SkinPatch& patch, const geometry::SurfaceMesh& target,
                                        const Unwanted& unwanted) {
  if (patch.after.triangles.empty()) return absl::FailedPreconditionError("the patch of the model has no triangle");
  if (patch.vertices.size() > kMaxPatchVertices) {
    return absl::ResourceExhaustedError(absl::StrCat("the patch has ", patch.vertices.size(),
                                                     " vertices, an evaluation holds at most ", kMaxPatchVertices));
  }
  const auto distance = geometry::compute_patch_distance(patch.after, target, unwanted);
  if (!distance.ok()) return distance.status();
  const auto before = geometry::compute_signed_distances(patch.before.points, target, unwanted);
  if (!before.ok()) return before.status();
  const auto volume_before = geometry::compute_volume_between(patch.before, target, unwanted);
  if (!volume_before.ok()) return volume_before.status();
  const auto volume_after = geometry::compute_volume_between(patch.after, target, unwanted);
  if (!volume_after.ok()) return volume_after.status();
  v1::Evaluation evaluation;
  *evaluation.mutable_simulated_to_target() = to_signed_statistics(distance->patch_to_target_statistics);
  *evaluation.mutable_target_to_simulated() = to_distance_statistics(distance->target_to_patch_statistics);
  evaluation.set_hausdorff_mm(
      std::max(evaluation.simulated_to_target().max_mm(), evaluation.target_to_simulated().max_mm()));
  *evaluation.mutable_before_to_target() = to_signed_statistics(geometry::compute_distance_statistics(*before));
  *evaluation.mutable_volume_before() = to_volume_to_target(*volume_before);
  *evaluation.mutable_volume_simulated() = to_volume_to_target(*volume_after);
  for (const double d : distance->patch_to_target) {
    evaluation.add_distance_mm(static_cast<float>(kMillimetresPerMetre * d));
  }
  evaluation.mutable_vertices()->Add(patch.vertices.begin(), patch.vertices.end());
  evaluation.set_mesh(patch.mesh);
  return evaluation;
}

}  // namespace lipofill::server
