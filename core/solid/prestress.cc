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
    for (int k = 0; k < 24; ++k)
      element.dof[k / 3][k % 3] = pattern.dof_of_component()[3 * element.nodes[k / 3] + k % 3];
    elements_.push_back(element);
  }
  if (elements_.empty()) return;
  stiffness_.setZero(pattern.matrix().nonZeros());
  for (const Element& element : elements_) {
    const Eigen::Matrix<double, 8, 8> k = element.gradient.transpose() * element.stress * element.gradient;
    for (int a = 0; a < 8; ++a) {
      for (int b = 0; b <= a; ++b) {
        for (int c = 0; c < 3; ++c) {
          if (element.dof[a][c] < 0 || element.dof[b][c] < 0) continue;
          stiffness_[pattern.find(element.dof[a][c], element.dof[b][c])] += k(a, b);
        }
      }
    }
  }
}

void Prestress::add_stiffness(Eigen::VectorXd& values) const {
  if (stiffness_.size() > 0) values.head(stiffness_.size()) += stiffness_;
}

double Prestress::add_force(const Eigen::Matrix3Xd& x, Eigen::VectorXd& force) const {
  double energy = 0.0;
  for (const Element& element : elements_) {
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int a = 0; a < 8; ++a) {
      gradient += (x.col(element.nodes[a]) - element.rest.col(a)) * element.gradient.col(a).transpose();
    }
    const Eigen::Matrix3d stress = gradient * element.stress;
    energy += 0.5 * stress.cwiseProduct(gradient).sum();
    for (int a = 0; a < 8; ++a) {
      const Eigen::Vector3d f = stress * element.gradient.col(a);
      for (int c = 0; c < 3; ++c) {
        if (element.dof[a][c] >= 0) force[element.dof[a][c]] += f[c];
      }
    }
  }
  return energy;
}

}  // namespace lipofill::solid
