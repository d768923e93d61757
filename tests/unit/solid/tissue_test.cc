#include "core/solid/tissue.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/base/field_violations.h"
#include "core/solid/incompatible_modes.h"
#include "core/solid/solid_shell.h"
#include "tests/unit/solid/box_mesh.h"

namespace lipofill::solid::testing {
namespace {

constexpr double kDt = 0.01;
constexpr double kStatic = std::numeric_limits<double>::infinity();

/// A small slab of two materials, solid-shell below and two EAS-9 elements above, held in several
/// ways.
struct Slab {
  Box box{{3, 2, 3}, {0.03, 0.02, 0.009}};
  std::vector<ElasticMaterial> materials = {{1e5, 0.45, 1000.0}, {2e4, 0.3, 920.0}};
  RayleighDamping damping{2.0, 0.003};
  NodeSupports supports;
  HexMesh mesh = box.make();

  Slab() {
    distort_inside(box, 0.15, 3, mesh);
    for (int e = 6; e < mesh.n_hexahedra(); ++e) {
      mesh.material[e] = 1;
      mesh.stacked[e] = true;
    }
    supports.fixed.resize(box.n_nodes(), {false, false, false});
    supports.spring.resize(box.n_nodes(), 0.0);
    for_each_node(box, [this](int a, int i, int j, int k) {
      supports.fixed[a] = {i == 0, j == 0 || (i == 0 && k == 0), i == 0 && k == 0};
      if (k == 3) supports.spring[a] = 5.0 + a;
    });
  }

  Tissue make() const { return Tissue::create(mesh, materials, supports, damping).value(); }

  Eigen::Matrix3Xd deformed(double amplitude, unsigned seed) const {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    Jitter jitter(seed);
    Eigen::Matrix3Xd x = R * mesh.rest_positions;
    for (int a = 0; a < x.cols(); ++a) x.col(a) += amplitude * jitter.next_vector();
    return x;
  }
};

/// The definitions, written out densely over all components.
struct DenseReference {
  Eigen::MatrixXd K;
  Eigen::VectorXd f;
  double energy = 0.0;

  DenseReference(const Slab& slab, const Eigen::Matrix3Xd& x) {
    const Eigen::Index n = x.size();
    K = Eigen::MatrixXd::Zero(n, n);
    f = Eigen::VectorXd::Zero(n);
    for (int e = 0; e < slab.mesh.n_hexahedra(); ++e) add_element(slab, x, e);
    for (int a = 0; a < x.cols(); ++a) {
      const Eigen::Vector3d stretch = x.col(a) - slab.mesh.rest_positions.col(a);
      for (int c = 0; c < 3; ++c) {
        if (slab.supports.fixed[a][c]) continue;
        K(3 * a + c, 3 * a + c) += slab.supports.spring[a];
        f[3 * a + c] += slab.supports.spring[a] * stretch[c];
        energy += 0.5 * slab.supports.spring[a] * stretch[c] * stretch[c];
      }
    }
  }

  void add_element(const Slab& slab, const Eigen::Matrix3Xd& x, int e) {
    const HexNodes X_e = slab.mesh.gather(e, slab.mesh.rest_positions);
    const HexNodes x_e = slab.mesh.gather(e, x);
    const auto D = compute_elasticity_matrix(slab.materials[slab.mesh.material[e]]);
    const HexStiffness K_e =
        slab.mesh.stacked[e] ? compute_incompatible_modes_stiffness(X_e, D) : compute_solid_shell_stiffness(X_e, D);
    const Eigen::Matrix3d F =
        compute_jacobian(x_e, LocalPoint::Zero()) * compute_jacobian(X_e, LocalPoint::Zero()).inverse();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
    const HexNodes d = R.transpose() * x_e - X_e;
    const Eigen::Matrix<double, 24, 1> force = K_e * Eigen::Map<const Eigen::Matrix<double, 24, 1>>(d.data());
    energy += 0.5 * force.dot(Eigen::Map<const Eigen::Matrix<double, 24, 1>>(d.data()));
    for (int a = 0; a < 8; ++a) {
      const int row = 3 * slab.mesh.hexahedra[e][a];
      f.segment<3>(row) += R * force.segment<3>(3 * a);
      for (int b = 0; b < 8; ++b) {
        K.block<3, 3>(row, 3 * slab.mesh.hexahedra[e][b]) += R * K_e.block<3, 3>(3 * a, 3 * b) * R.transpose();
      }
    }
  }

  Eigen::VectorXd restrict_vector(const Tissue& tissue) const {
    Eigen::VectorXd v(tissue.n_dofs());
    for (Eigen::Index i = 0; i < f.size(); ++i) {
      if (tissue.dof_of_component()[i] >= 0) v[tissue.dof_of_component()[i]] = f[i];
    }
    return v;
  }

  Eigen::MatrixXd restrict_matrix(const Tissue& tissue) const {
    Eigen::MatrixXd A(tissue.n_dofs(), tissue.n_dofs());
    const std::vector<int>& dof = tissue.dof_of_component();
    for (Eigen::Index i = 0; i < f.size(); ++i) {
      for (Eigen::Index j = 0; j < f.size(); ++j) {
        if (dof[i] >= 0 && dof[j] >= 0) A(dof[i], dof[j]) = K(i, j);
      }
    }
    return A;
  }
};

Eigen::MatrixXd full(const Eigen::SparseMatrix<double>& lower) {
  return Eigen::MatrixXd(Eigen::SparseMatrix<double>(lower.selfadjointView<Eigen::Lower>()));
}

TEST(Tissue, AssemblesWhatTheDefinitionSays) {
  const Slab slab;
  Tissue tissue = slab.make();
  const Eigen::Matrix3Xd x = slab.deformed(3e-4, 8);
  tissue.assemble(x, kDt);
  const DenseReference reference(slab, x);
  const Eigen::VectorXd f = reference.restrict_vector(tissue);
  EXPECT_LT((tissue.internal_force() - f).norm(), 1e-11 * f.norm());
  EXPECT_NEAR(tissue.elastic_energy(), reference.energy, 1e-11 * reference.energy);

  const Eigen::MatrixXd K = reference.restrict_matrix(tissue);
  for (int dof = 0; dof < tissue.n_dofs(); ++dof) {
    const Eigen::VectorXd column = tissue.stiffness_times(Eigen::VectorXd::Unit(tissue.n_dofs(), dof));
    EXPECT_LT((column - K.col(dof)).norm(), 1e-12 * K.norm());
  }
}

Eigen::VectorXd mass_of_dofs(const Tissue& tissue) {
  Eigen::VectorXd mass(tissue.n_dofs());
  for (size_t component = 0; component < tissue.dof_of_component().size(); ++component) {
    const int dof = tissue.dof_of_component()[component];
    if (dof >= 0) mass[dof] = tissue.mass()[static_cast<Eigen::Index>(component / 3)];
  }
  return mass;
}

/// S = M (1/dt^2 + alpha/dt) + (1 + beta/dt) K at rest, where nothing is stressed.
TEST(Tissue, SystemMatrixAtRest) {
  const Slab slab;
  Tissue tissue = slab.make();
  tissue.assemble(slab.mesh.rest_positions, kDt);
  const DenseReference reference(slab, slab.mesh.rest_positions);
  Eigen::MatrixXd S = (1.0 + slab.damping.beta / kDt) * reference.restrict_matrix(tissue);
  S.diagonal() += mass_of_dofs(tissue) * (1.0 / (kDt * kDt) + slab.damping.alpha / kDt);
  EXPECT_LT((full(tissue.system_matrix()) - S).norm(), 1e-12 * S.norm());
}

/// What the step adds to the static matrix of the same deformed state is inertia and damping: M
/// (1/dt^2 + alpha/dt) + beta/dt K.
TEST(Tissue, StepAddsInertiaAndDamping) {
  const Slab slab;
  Tissue tissue = slab.make();
  const Eigen::Matrix3Xd x = slab.deformed(3e-4, 9);
  tissue.assemble(x, kStatic);
  const Eigen::MatrixXd S_static = full(tissue.system_matrix());
  tissue.assemble(x, kDt);
  Eigen::MatrixXd added = slab.damping.beta / kDt * DenseReference(slab, x).restrict_matrix(tissue);
  added.diagonal() += mass_of_dofs(tissue) * (1.0 / (kDt * kDt) + slab.damping.alpha / kDt);
  EXPECT_LT((full(tissue.system_matrix()) - S_static - added).norm(), 1e-12 * S_static.norm());
}

TEST(Tissue, RestCostsNothing) {
  const Slab slab;
  Tissue tissue = slab.make();
  tissue.assemble(slab.mesh.rest_positions, kDt);
  EXPECT_LT(tissue.internal_force().cwiseAbs().maxCoeff(), 1e-14 * full(tissue.system_matrix()).norm());
  EXPECT_LT(tissue.elastic_energy(), 1e-25);
  EXPECT_NEAR(tissue.min_volume_ratio(), 1.0, 1e-14);
}

/// K is the derivative of f_int at rest, and off by the strain elsewhere: turning is no reason to
/// be off.
TEST(Tissue, StiffnessIsTheDerivativeOfTheForceUpToStrain) {
  const Slab slab;
  Tissue tissue = slab.make();
  const auto relative_error = [&](double strain_amplitude) {
    const Eigen::Matrix3Xd x = slab.deformed(strain_amplitude, 5);
    Tissue free = Tissue::create(slab.mesh, slab.materials, {}, {}).value();
    Eigen::Matrix3Xd direction(3, x.cols());
    Jitter jitter(6);
    for (int a = 0; a < x.cols(); ++a) direction.col(a) = jitter.next_vector();
    const double h = 1e-7;
    free.assemble(x + h * direction, kStatic);
    const Eigen::VectorXd forward = free.internal_force();
    free.assemble(x - h * direction, kStatic);
    const Eigen::VectorXd difference = (forward - free.internal_force()) / (2.0 * h);
    free.assemble(x, kStatic);
    const Eigen::VectorXd tangent =
        free.stiffness_times(Eigen::Map<const Eigen::VectorXd>(direction.data(), direction.size()));
    return (difference - tangent).norm() / tangent.norm();
  };
  EXPECT_LT(relative_error(0.0), 1e-7);
  const double small = relative_error(1e-5);
  const double large = relative_error(1e-4);
  EXPECT_LT(small, 0.01);
  EXPECT_NEAR(large / small, 10.0, 1.0);
}

TEST(Tissue, MassIsDensityTimesVolume) {
  const Slab slab;  // distorted inside only: the volume of each material's part is not the box's share
  const Tissue tissue = slab.make();
  double expected = 0.0;
  for (int e = 0; e < slab.mesh.n_hexahedra(); ++e) {
    const HexNodes nodes = slab.mesh.gather(e, slab.mesh.rest_positions);
    // 3 x 3 x 3 Gauss points: more than the trilinear Jacobian needs.
    const double g = std::sqrt(0.6);
    for (const double xi : {-g, 0.0, g}) {
      for (const double eta : {-g, 0.0, g}) {
        for (const double zeta : {-g, 0.0, g}) {
          const auto weight = [](double s) { return s == 0.0 ? 8.0 / 9.0 : 5.0 / 9.0; };
          const double volume = compute_jacobian(nodes, {xi, eta, zeta}).determinant();
          expected += weight(xi) * weight(eta) * weight(zeta) * volume * slab.materials[slab.mesh.material[e]].density;
        }
      }
    }
  }
  EXPECT_NEAR(tissue.mass().sum(), expected, 1e-14 * expected);
  EXPECT_GT(tissue.mass().minCoeff(), 0.0);

  Slab uniform;
  uniform.materials[1] = uniform.materials[0];
  EXPECT_NEAR(uniform.make().mass().sum(), 1000.0 * uniform.box.size.prod(), 1e-17);
}

TEST(Tissue, NumbersFreeComponentsNodeByNode) {
  const Slab slab;
  const Tissue tissue = slab.make();
  int next = 0;
  for (int a = 0; a < slab.box.n_nodes(); ++a) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(tissue.dof_of_component()[3 * a + c], slab.supports.fixed[a][c] ? -1 : next++);
    }
  }
  EXPECT_EQ(tissue.n_dofs(), next);
}

TEST(Tissue, PatternIsSortedLowerAndFixed) {
  const Slab slab;
  Tissue tissue = slab.make();
  const Eigen::SparseMatrix<double> before = tissue.system_matrix();
  tissue.assemble(slab.deformed(1e-3, 2), 1e-4);
  const Eigen::SparseMatrix<double>& after = tissue.system_matrix();
  ASSERT_EQ(before.nonZeros(), after.nonZeros());
  EXPECT_TRUE(std::equal(before.outerIndexPtr(), before.outerIndexPtr() + before.cols() + 1, after.outerIndexPtr()));
  EXPECT_TRUE(std::equal(before.innerIndexPtr(), before.innerIndexPtr() + before.nonZeros(), after.innerIndexPtr()));
  for (int column = 0; column < after.cols(); ++column) {
    int last = column - 1;
    for (Eigen::SparseMatrix<double>::InnerIterator it(after, column); it; ++it) {
      EXPECT_GT(it.row(), last);
      last = static_cast<int>(it.row());
    }
    EXPECT_EQ(Eigen::SparseMatrix<double>::InnerIterator(after, column).row(), column);
  }
}

/// What was assembled before leaves no trace, and a moved tissue works on.
TEST(Tissue, DependsOnTheLastAssembleAlone) {
  const Slab slab;
  const Eigen::Matrix3Xd x = slab.deformed(4e-4, 1);
  Tissue fresh = slab.make();
  fresh.assemble(x, kDt);
  Tissue used = slab.make();
  for (unsigned seed = 2; seed < 6; ++seed) used.assemble(slab.deformed(2e-3, seed), 0.1 * seed);
  Tissue moved = std::move(used);
  moved.assemble(x, kDt);
  const size_t force_bytes = sizeof(double) * fresh.internal_force().size();
  const size_t matrix_bytes = sizeof(double) * fresh.system_matrix().nonZeros();
  EXPECT_EQ(std::memcmp(fresh.internal_force().data(), moved.internal_force().data(), force_bytes), 0);
  EXPECT_EQ(std::memcmp(fresh.system_matrix().valuePtr(), moved.system_matrix().valuePtr(), matrix_bytes), 0);
  EXPECT_EQ(fresh.elastic_energy(), moved.elastic_energy());
}

void expect_same_bits(const Tissue& a, const Tissue& b) {
  const size_t force_bytes = sizeof(double) * a.internal_force().size();
  const size_t matrix_bytes = sizeof(double) * a.system_matrix().nonZeros();
  EXPECT_EQ(std::memcmp(a.internal_force().data(), b.internal_force().data(), force_bytes), 0);
  EXPECT_EQ(std::memcmp(a.system_matrix().valuePtr(), b.system_matrix().valuePtr(), matrix_bytes), 0);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(a.n_dofs());
  const Eigen::VectorXd stiffness = a.stiffness_times(ones);
  EXPECT_EQ(std::memcmp(stiffness.data(), b.stiffness_times(ones).eval().data(), force_bytes), 0);
  EXPECT_EQ(a.elastic_energy(), b.elastic_energy());
}

/// Under tension and squeezed flat in places, so that every term that knows the modulus has its
/// say.
TEST(Tissue, ModuliSetLaterGiveTheBitsOfATissueBuiltWithThem) {
  Slab slab;
  slab.materials[0].prestress = 300.0;
  Tissue changed = slab.make();
  const std::shared_ptr<const TissueStructure> structure = changed.structure();
  Slab other = slab;
  other.materials[0].youngs_modulus = 31234.5;
  other.materials[1].youngs_modulus = 7.7e4;
  Tissue built = other.make();
  for (const double amplitude : {3e-4, 2e-3}) {
    const Eigen::Matrix3Xd x = slab.deformed(amplitude, 4);
    changed.assemble(x, kDt);
    ASSERT_TRUE(changed.set_youngs_moduli({31234.5, 7.7e4}).ok());
    changed.assemble(x, kDt);
    built.assemble(x, kDt);
    expect_same_bits(changed, built);
    ASSERT_TRUE(changed.set_youngs_moduli({1e5, 2e4}).ok());
    changed.compute_force(x);
    EXPECT_GT((changed.internal_force() - built.internal_force()).norm(), 0.1 * built.internal_force().norm());
  }
  EXPECT_EQ(changed.structure(), structure);
}

TEST(Tissue, WrongModuliAreNamedAndChangeNothing) {
  const Slab slab;
  Tissue tissue = slab.make();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<double>> wrong = {{1e5}, {1e5, 2e4, 1e4}, {0.0, 2e4}, {1e5, -1.0}, {1e5, nan}};
  for (const std::vector<double>& moduli : wrong) {
    EXPECT_EQ(tissue.set_youngs_moduli(moduli).code(), absl::StatusCode::kInvalidArgument);
  }
  EXPECT_EQ(field_violations_of(tissue.set_youngs_moduli({1e5, -1.0}))[0].field, "youngs_moduli[1]");
  tissue.assemble(slab.deformed(3e-4, 4), kDt);
  Tissue untouched = slab.make();
  untouched.assemble(slab.deformed(3e-4, 4), kDt);
  expect_same_bits(tissue, untouched);
}

TEST(Tissue, SeesElementsTurnedInsideOut) {
  const Slab slab;
  Tissue tissue = slab.make();
  Eigen::Matrix3Xd x = slab.mesh.rest_positions;
  x.row(2) *= -0.5;
  tissue.assemble(x, kDt);
  EXPECT_NEAR(tissue.min_volume_ratio(), -0.5, 1e-12);
  EXPECT_TRUE(tissue.internal_force().allFinite());
  x(0, 7) = std::numeric_limits<double>::quiet_NaN();
  tissue.assemble(x, kDt);
  EXPECT_EQ(tissue.min_volume_ratio(), -std::numeric_limits<double>::infinity());
}

TEST(Tissue, MayBeEmpty) {
  Tissue tissue = Tissue::create({}, {}, {}, {}).value();
  tissue.assemble(Eigen::Matrix3Xd(3, 0), kDt);
  EXPECT_EQ(tissue.n_dofs(), 0);
  EXPECT_EQ(tissue.system_matrix().nonZeros(), 0);
}

}  // namespace
}  // namespace lipofill::solid::testing
