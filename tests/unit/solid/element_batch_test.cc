#include "core/solid/element_batch.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstring>

#include "core/solid/element_assembler.h"
#include "core/solid/geometric_stiffness.h"
#include "core/solid/inversion_barrier.h"
#include "core/solid/rotation.h"
#include "core/solid/solid_shell.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

constexpr double kModulus = 1e5;

/// Distorted hexahedra in a row, as many as a batch has lanes.
struct Row {
  Box box{{kLanes, 1, 1}, {0.02, 0.004, 0.002}};
  HexMesh mesh = box.make();
  std::vector<HexStiffness> K;
  ElementBatch batch;

  Row() {
    Jitter jitter(11);
    for (int a = 0; a < mesh.n_nodes(); ++a) mesh.rest_positions.col(a) += 3e-4 * jitter.next_vector();
    for (int lane = 0; lane < kLanes; ++lane) {
      const HexNodes nodes = mesh.gather(lane, mesh.rest_positions);
      K.push_back(compute_solid_shell_stiffness(nodes, compute_elasticity_matrix({kModulus, 0.45, 1000.0})));
      batch.set_lane(lane, mesh.hexahedra[lane], nodes, K.back() / kModulus);
    }
  }

  Eigen::Matrix3Xd shaken(double amplitude, unsigned seed) const {
    Jitter jitter(seed);
    Eigen::Matrix3Xd x = mesh.rest_positions;
    for (int a = 0; a < x.cols(); ++a) x.col(a) += amplitude * jitter.next_vector();
    return x;
  }

  Eigen::Matrix3d deformation_gradient(int lane, const Eigen::Matrix3Xd& x) const {
    const LocalPoint centre = LocalPoint::Zero();
    return compute_jacobian(mesh.gather(lane, x), centre) *
           compute_jacobian(mesh.gather(lane, mesh.rest_positions), centre).inverse();
  }
};

Eigen::Matrix4Xd four_a_node(const Eigen::Matrix3Xd& x) {
  Eigen::Matrix4Xd padded = Eigen::Matrix4Xd::Zero(4, x.cols());
  padded.topRows<3>() = x;
  return padded;
}

/// R K R^T and forces R K (R^T x - X) with the rotation of compute_nearest_rotation, node by node.
struct Expected {
  Eigen::Matrix3Xd force;
  double energy = 0.0;
  Eigen::MatrixXd stiffness;

  Expected(const Row& row, const Eigen::Matrix3Xd& x)
      : force(Eigen::Matrix3Xd::Zero(3, x.cols())), stiffness(Eigen::MatrixXd::Zero(x.size(), x.size())) {
    for (int e = 0; e < row.mesh.n_hexahedra(); ++e) {
      const Eigen::Matrix3d R = compute_nearest_rotation(row.deformation_gradient(e, x));
      HexNodes d = R.transpose() * row.mesh.gather(e, x) - row.mesh.gather(e, row.mesh.rest_positions);
      const Eigen::Map<const Eigen::Matrix<double, 24, 1>> local(d.data());
      const Eigen::Matrix<double, 24, 1> f = row.K[e] * local;
      energy += 0.5 * f.dot(local);
      for (int a = 0; a < 8; ++a) {
        const int node_a = row.mesh.hexahedra[e][a];
        force.col(node_a) += R * f.segment<3>(3 * a);
        for (int b = 0; b < 8; ++b) {
          stiffness.block<3, 3>(3 * node_a, 3 * row.mesh.hexahedra[e][b]) +=
              R * row.K[e].block<3, 3>(3 * a, 3 * b) * R.transpose();
        }
      }
    }
  }
};

/// Also where elements are crushed or turned inside out.
TEST(ElementBatch, ForcesMatchTheDefinition) {
  const Row row;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const Eigen::Matrix3Xd x = row.shaken(seed <= 15 ? 2e-4 : 3e-3, seed);
    Eigen::Matrix4Xd force = Eigen::Matrix4Xd::Zero(4, x.cols());
    ElementPose pose;
    add_element_forces(row.batch, fill_lanes(kModulus), four_a_node(x).data(), pose, force.data());
    const Expected expected(row, x);
    EXPECT_LT((force.topRows<3>() - expected.force).norm(), 1e-9 * expected.force.norm());
    double energy = 0.0;
    for (int lane = 0; lane < kLanes; ++lane) {
      energy += pose.energy[lane];
      const Eigen::Matrix3d F = row.deformation_gradient(lane, x);
      EXPECT_NEAR(pose.volume_ratio[lane], F.determinant(), 1e-11 * (1.0 + F.squaredNorm() * F.norm()));
    }
    EXPECT_NEAR(energy, expected.energy, 1e-9 * expected.energy);
  }
}

TEST(ElementBatch, LeastCornerIsThatOfTheEdges) {
  const Row row;
  const Eigen::Matrix3Xd x = row.shaken(1e-3, 5);
  Eigen::Matrix4Xd force = Eigen::Matrix4Xd::Zero(4, x.cols());
  ElementPose pose;
  add_element_forces(row.batch, fill_lanes(kModulus), four_a_node(x).data(), pose, force.data());
  for (int lane = 0; lane < kLanes; ++lane) {
    double least = 1.0;
    for (int a = 0; a < 8; ++a) {
      const HexNodes nodes = row.mesh.gather(lane, x);
      least = std::min(least, 8.0 * compute_jacobian(nodes, hex_corners().col(a)).determinant());
    }
    EXPECT_NEAR(pose.least_corner[lane], least, 1e-12 * std::abs(least));
  }
}

/// A mesh and its node numbers turned about: hexahedra then fall into several batches, some not
/// full, and blocks are stored as they are and transposed.
struct Shuffled {
  Row row;
  std::vector<ElasticMaterial> materials{{kModulus, 0.45, 1000.0}};

  Shuffled() {
    const int n = row.mesh.n_nodes();
    std::vector<int> place(n);
    for (int a = 0; a < n; ++a) place[a] = (7 * a + 3) % n;
    Eigen::Matrix3Xd rest(3, n);
    for (int a = 0; a < n; ++a) rest.col(place[a]) = row.mesh.rest_positions.col(a);
    row.mesh.rest_positions = rest;
    for (auto& hexahedron : row.mesh.hexahedra) {
      for (int& node : hexahedron) node = place[node];
    }
  }
};

TEST(ElementAssembler, MatchesTheDefinitionWhateverTheOrderOfNodes) {
  const Shuffled shuffled;
  const HexMesh& mesh = shuffled.row.mesh;
  std::vector<std::array<bool, 3>> fixed(mesh.n_nodes(), {false, false, false});
  fixed[2] = {true, true, true};
  fixed[5] = {false, true, false};
  const SystemPattern pattern(mesh.n_nodes(), mesh.hexahedra, fixed);
  const ElementAssembler assembler(mesh, shuffled.materials, pattern);
  const std::vector<double> moduli = assembler.spread_moduli(mesh, {kModulus});
  const Eigen::Matrix3Xd x = shuffled.row.shaken(2e-4, 3);
  NodeBlocks blocks(pattern);
  blocks.set_zero();
  std::vector<int> squeezed;
  Eigen::Matrix4Xd force = Eigen::Matrix4Xd::Zero(4, x.cols()), alone = force;
  const ElementTotals totals = assembler.add(moduli, four_a_node(x), force, squeezed, blocks);
  assembler.add_forces(moduli, four_a_node(x), alone, squeezed);
  EXPECT_EQ(std::memcmp(force.data(), alone.data(), sizeof(double) * force.size()), 0);
  EXPECT_TRUE(squeezed.empty());
  EXPECT_FALSE(totals.is_folded);

  const Expected expected(shuffled.row, x);
  EXPECT_LT((force.topRows<3>() - expected.force).norm(), 1e-9 * expected.force.norm());
  Eigen::SparseMatrix<double> system = pattern.make_matrix();
  Eigen::VectorXd stiffness(pattern.n_values());
  blocks.write(pattern, {}, 1.0, stiffness.data(), system.valuePtr());
  const std::vector<int>& dofs = pattern.dof_of_component();
  for (size_t i = 0; i < dofs.size(); ++i) {
    for (size_t j = 0; j < dofs.size(); ++j) {
      if (dofs[i] < dofs[j] || dofs[j] < 0) continue;
      const bool is_coupled = system.coeff(dofs[i], dofs[j]) != 0.0;
      const double found = is_coupled ? stiffness[pattern.find(dofs[i], dofs[j])] : 0.0;
      EXPECT_NEAR(found, expected.stiffness(i, j), 1e-9 * expected.stiffness.norm()) << i << " " << j;
    }
  }
}

TEST(ElementAssembler, TellsWhatIsSqueezedAndFolded) {
  const Row row;
  const SystemPattern pattern(row.mesh.n_nodes(), row.mesh.hexahedra,
                              std::vector<std::array<bool, 3>>(row.mesh.n_nodes(), {false, false, false}));
  const ElementAssembler assembler(row.mesh, {{kModulus, 0.45, 1000.0}}, pattern);
  const std::vector<double> moduli = assembler.spread_moduli(row.mesh, {kModulus});
  const int node = row.mesh.hexahedra[2][6];  // of hexahedra 2 and 3
  for (const double share : {0.0, 0.8, 1.2}) {
    Eigen::Matrix3Xd x = row.mesh.rest_positions;
    x(2, node) -= share * 0.002;
    Eigen::Matrix4Xd force = Eigen::Matrix4Xd::Zero(4, x.cols());
    std::vector<int> squeezed;
    const ElementTotals totals = assembler.add_forces(moduli, four_a_node(x), force, squeezed);
    EXPECT_EQ(squeezed, share == 0.0 ? std::vector<int>() : std::vector<int>({2, 3})) << share;
    EXPECT_EQ(totals.is_folded, share > 1.0);
  }
}

}  // namespace
}  // namespace lipofill::solid::testing
