#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "core/geometry/scalar_field.h"
#include "core/geometry/surface_locator.h"
#include "core/geometry/surface_mesh.h"
#include "core/geometry/surface_topology.h"
#include "core/model/face_model.h"

namespace lipofill::planning {

/// Points that move with the skin of a model, bilinear between its nodes, with the area each stands
/// for: the scan's vertices that ride on it, or the nodes where there is no scan.
/// Checked by tests/unit/planning/proposal_test.cc.
struct SkinPoints {
  geometry::SurfaceMesh rest;                ///< the patch they make at rest
  std::vector<geometry::ChartPoint> place;   ///< a place a point
  std::vector<std::array<int, 4>> nodes;     ///< of the skin, around each point
  std::vector<std::array<double, 4>> share;  ///< of each of these
  Eigen::VectorXd area;                      ///< a third of the triangles around it [m2]

  Eigen::Index n() const { return rest.points.cols(); }
  /// Values at the points of a field on the nodes (3, nodes_per_level).
  Eigen::Matrix3Xd gather(const Eigen::Matrix3Xd& on_nodes) const;
};

/// Makes them from the vertices of a face's scan, or from the nodes of a square.
SkinPoints make_skin_points(const model::FaceModel& model);
/// The nodes of the skin, face or square.
SkinPoints make_node_points(const model::FaceModel& model);

/// The side tells how a point lies to a target.
struct TargetSide {
  double distance = 0.0;                                 ///< positive outside of it [m]
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< gradient of the distance
  bool is_off = false;                                   ///< nearest to the target's border: not compared
};

/// Signed distance to a target and its gradient, for many points near one patch. Only the part of
/// the target near the patch is searched. Distances are those of
/// geometry::compute_signed_distances. Checked by tests/unit/planning/proposal_test.cc.
class TargetDistance {
 public:
  /// @param patch  at rest; points asked about are less than `reach` from it
  TargetDistance(const geometry::SurfaceMesh& target, const geometry::SurfaceMesh& patch, double reach);

  /// True when no triangle of the target is near the patch.
  bool is_empty() const { return near_.triangles.empty(); }
  /// The part of the target that is searched.
  const geometry::SurfaceMesh& surface() const { return near_; }
  TargetSide at(const Eigen::Vector3d& point) const;

 private:
  geometry::SurfaceMesh near_;
  Eigen::Matrix3Xd normals_;
  std::vector<bool> is_border_;  ///< a vertex
  std::unique_ptr<geometry::SurfaceLocator> locator_;
};

/// Finds what the skin at rest lacks to the target, positive where the target lies outside, at the
/// nodes of the skin: smoothed over the chart by a Gaussian of `length`, so that noise of a scan is
/// not taken for a hollow. Nodes that have no target opposite take the mean of those around, 0
/// where none has. Checked by tests/unit/planning/proposal_test.cc.
geometry::ScalarField smooth_deficit(const model::FaceModel& model, const TargetDistance& target, double length);

}  // namespace lipofill::planning
