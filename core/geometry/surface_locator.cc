#include "core/geometry/surface_locator.h"

#include <SMP/Common/vtkSMPToolsAPI.h>
#include <vtkCellArray.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>

#include <Eigen/Dense>
#include <cmath>

namespace lipofill::geometry {

struct SurfaceLocator::Impl {
  vtkNew<vtkPolyData> surface;
  vtkNew<vtkStaticCellLocator> locator;
  vtkNew<vtkGenericCell> cell;
};

namespace {

void fill(vtkPolyData* surface, const SurfaceMesh& mesh) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(mesh.n_vertices());
  for (int v = 0; v < mesh.n_vertices(); ++v) points->SetPoint(v, mesh.points.col(v).data());
  vtkNew<vtkCellArray> cells;
  cells->AllocateExact(mesh.n_triangles(), 3 * static_cast<vtkIdType>(mesh.n_triangles()));
  for (const auto& triangle : mesh.triangles) {
    const vtkIdType corners[3] = {triangle[0], triangle[1], triangle[2]};
    cells->InsertNextCell(3, corners);
  }
  surface->SetPoints(points);
  surface->SetPolys(cells);
}

/// VTK sorts the cells of the locator's boxes in parallel and by box alone: which of two triangles
/// at the same distance is found would change from one build to the next. (vtkSMPTools.h, the front
/// of this interface, is not C++20.)
void build_in_one_thread(vtkStaticCellLocator* locator) {
  [[maybe_unused]] static const bool is_sequential =
      vtk::detail::smp::vtkSMPToolsAPI::GetInstance().SetBackend("Sequential");
  locator->BuildLocator();
}

}  // namespace

SurfaceLocator::SurfaceLocator(const SurfaceMesh& mesh) : impl_(std::make_unique<Impl>()) {
  fill(impl_->surface, mesh);
  impl_->locator->SetNumberOfCellsPerNode(1);
  impl_->locator->SetDataSet(impl_->surface);
  build_in_one_thread(impl_->locator);
}

SurfaceLocator::~SurfaceLocator() = default;

SurfacePoint SurfaceLocator::find_nearest(const Eigen::Vector3d& point) const {
  SurfacePoint nearest;
  vtkIdType cell_id = -1;
  int sub_id = 0;
  double squared_distance = 0.0;
  impl_->locator->FindClosestPoint(point.data(), nearest.position.data(), impl_->cell, cell_id, sub_id,
                                   squared_distance);
  nearest.triangle = static_cast<int>(cell_id);
  nearest.distance = std::sqrt(squared_distance);
  return nearest;
}

Eigen::Vector3d compute_barycentric(const SurfaceMesh& mesh, int triangle, const Eigen::Vector3d& position) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Eigen::Vector3d e1 = mesh.points.col(b) - mesh.points.col(a);
  const Eigen::Vector3d e2 = mesh.points.col(c) - mesh.points.col(a);
  const Eigen::Vector3d n = e1.cross(e2);
  const Eigen::Vector3d p = position - mesh.points.col(a);
  const double u = p.cross(e2).dot(n) / n.squaredNorm();
  const double v = e1.cross(p).dot(n) / n.squaredNorm();
  return {1.0 - u - v, u, v};
}

}  // namespace lipofill::geometry
