#include "core/solid/prestress.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/solid/hex_shape.h"

namespace lipofill::solid {

Prestress::Prestress(const HexMesh& mesh, const std::vector<ElasticMaterial>& materials, const SystemPattern& pattern) {
  const Eigen::Matrix<double, 8, 3> derivatives = compute_shape_derivatives(LocalPoint::Zero());
  for (int e = 0; e < mesh.n_hexahedra(); ++e) {
    const double tension = materials[mesh.material[e]].prestress;
    if (tension == 0.0) continue;
    Element element;
    element.nodes = mesh.hexahedra[e];
    element.rest = mesh.gather(e, mesh.rest_positions);
    const Eigen::Matrix3d J = element.rest * derivatives;
    element.gradient = (derivatives * J.inverse()).transpose();
    const Eigen::Vector3d n = J.col(0).cross(J.col(1)).normalized();
    element.stress = 8.0 * J.determinant() * tension * (Eigen::Matrix3d::Identity() - n * n.transpose());
    elements_.push_back(element);
  }
  if (elements_.empty()) return;
  stiffness_.setZero(pattern.n_blocks() + 1);
  for (const Element& element : elements_) {
    const Eigen::Matrix<double, 8, 8> k = element.gradient.transpose() * element.stress * element.gradient;
    for (int a = 0; a < 8; ++a) {
      for (int b = 0; b <= a; ++b) stiffness_[pattern.find_block(element.nodes[a], element.nodes[b])] += k(a, b);
    }
  }
}

double Prestress::add_force(const Eigen::Matrix4Xd& x, Eigen::Matrix4Xd& force) const {
  double energy = 0.0;
  for (const Element& element : elements_) {
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int a = 0; a < 8; ++a) {
      gradient += (x.col(element.nodes[a]).head<3>() - element.rest.col(a)) * element.gradient.col(a).transpose();
    }
    const Eigen::Matrix3d stress = gradient * element.stress;
    energy += 0.5 * stress.cwiseProduct(gradient).sum();
    for (int a = 0; a < 8; ++a) force.col(element.nodes[a]).head<3>() += stress * element.gradient.col(a);
  }
  return energy;
}

}  // namespace lipofill::solid
