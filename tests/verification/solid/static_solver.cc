#include "tests/verification/solid/static_solver.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <limits>
#include <numbers>

namespace lipofill::solid::testing {
namespace {

constexpr double kStatic = std::numeric_limits<double>::infinity();
using Solver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower>;

Eigen::VectorXd to_dofs(const Tissue& tissue, const Eigen::Matrix3Xd& values) {
  Eigen::VectorXd v(tissue.n_dofs());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const int dof = tissue.dof_of_component()[i];
    if (dof >= 0) v[dof] = values.data()[i];
  }
  return v;
}

void add_dofs(const Tissue& tissue, const Eigen::VectorXd& v, Eigen::Matrix3Xd& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const int dof = tissue.dof_of_component()[i];
    if (dof >= 0) values.data()[i] += v[dof];
  }
}

/// Rows and columns of a lower triangle whose number is not negative, renumbered.
Eigen::SparseMatrix<double> extract(const Eigen::SparseMatrix<double>& lower, const std::vector<int>& number, int n) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < lower.cols(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it) {
      if (number[it.row()] >= 0 && number[column] >= 0)
        entries.emplace_back(number[it.row()], number[column], it.value());
    }
  }
  Eigen::SparseMatrix<double> part(n, n);
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

/// d f_int / dx over the degrees of freedom.
Eigen::MatrixXd compute_force_jacobian(Tissue& tissue, const Eigen::Matrix3Xd& x) {
  const Eigen::Matrix3Xd& rest = tissue.mesh().rest_positions;
  const double h = 1e-7 * (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).maxCoeff();
  Eigen::MatrixXd jacobian(tissue.n_dofs(), tissue.n_dofs());
  Eigen::Matrix3Xd moved = x;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const int dof = tissue.dof_of_component()[i];
    if (dof < 0) continue;
    moved.data()[i] = x.data()[i] + h;
    tissue.assemble(moved, kStatic);
    jacobian.col(dof) = tissue.internal_force();
    moved.data()[i] = x.data()[i] - h;
    tissue.assemble(moved, kStatic);
    jacobian.col(dof) = (jacobian.col(dof) - tissue.internal_force()) / (2.0 * h);
    moved.data()[i] = x.data()[i];
  }
  return jacobian;
}

}  // namespace

Eigen::Matrix3Xd solve_linear(Tissue& tissue, const Eigen::Matrix3Xd& force) {
  tissue.assemble(tissue.mesh().rest_positions, kStatic);
  const Solver solver(tissue.system_matrix());
  Eigen::Matrix3Xd u = Eigen::Matrix3Xd::Zero(3, tissue.mesh().n_nodes());
  add_dofs(tissue, solver.solve(to_dofs(tissue, force)), u);
  return u;
}

Eigen::Matrix3Xd solve_prescribed(Tissue& tissue, const std::vector<bool>& held, const Eigen::Matrix3Xd& prescribed) {
  std::vector<int> number;
  int n_free = 0;
  for (const bool is_held : held) {
    for (int c = 0; c < 3; ++c) number.push_back(is_held ? -1 : n_free++);
  }
  Eigen::Matrix3Xd u = prescribed;
  for (int a = 0; a < u.cols(); ++a) {
    if (!held[a]) u.col(a).setZero();
  }
  tissue.assemble(tissue.mesh().rest_positions, kStatic);
  const Eigen::VectorXd reaction = tissue.stiffness_times(Eigen::Map<const Eigen::VectorXd>(u.data(), u.size()));
  Eigen::VectorXd load(n_free);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (number[i] >= 0) load[number[i]] = -reaction[i];
  }
  const Eigen::VectorXd free = Solver(extract(tissue.system_matrix(), number, n_free)).solve(load);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (number[i] >= 0) u.data()[i] = free[number[i]];
  }
  return u;
}

StaticState solve_static(Tissue& tissue, const Eigen::Matrix3Xd& force, int n_increments) {
  constexpr int kMaxIterations = 30;
  StaticState state;
  state.x = tissue.mesh().rest_positions;
  const Eigen::VectorXd f = to_dofs(tissue, force);
  for (int increment = 1; increment <= n_increments; ++increment) {
    const double share = static_cast<double>(increment) / n_increments;
    state.converged = false;
    for (int k = 0; k < kMaxIterations && !state.converged; ++k, ++state.iterations) {
      tissue.assemble(state.x, kStatic);
      const Eigen::VectorXd residual = share * f - tissue.internal_force();
      state.converged = residual.norm() < 1e-8 * f.norm();
      add_dofs(tissue, compute_force_jacobian(tissue, state.x).partialPivLu().solve(residual), state.x);
    }
    if (!state.converged) break;
  }
  return state;
}

StaticState solve_large_deformation(Tissue& tissue, const LargeDeformation& problem, int n_increments) {
  constexpr int kMaxIterations = 200;
  const Eigen::Matrix3Xd& rest = tissue.mesh().rest_positions;
  std::vector<int> number;
  int n_free = 0;
  for (const std::array<bool, 3>& held : problem.held) {
    for (const bool is_held : held) number.push_back(is_held ? -1 : n_free++);
  }
  const auto gather_free = [&](const double* values) {
    Eigen::VectorXd free(n_free);
    for (size_t i = 0; i < number.size(); ++i) {
      if (number[i] >= 0) free[number[i]] = values[i];
    }
    return free;
  };
  const auto move = [&](const Eigen::VectorXd& by, double share, Eigen::Matrix3Xd x) {
    for (size_t i = 0; i < number.size(); ++i) {
      if (number[i] >= 0) x.data()[i] += share * by[number[i]];
    }
    return x;
  };
  StaticState state;
  state.x = rest;
  for (int increment = 1; increment <= n_increments; ++increment) {
    const double share = static_cast<double>(increment) / n_increments;
    for (size_t i = 0; i < number.size(); ++i) {
      if (number[i] < 0) state.x.data()[i] = rest.data()[i] + share * (problem.prescribed.data()[i] - rest.data()[i]);
    }
    const auto potential = [&](const Eigen::Matrix3Xd& x) {
      tissue.compute_force(x);
      return tissue.elastic_energy() - share * problem.force.cwiseProduct(x - rest).sum();
    };
    state.converged = false;
    for (int k = 0; k < kMaxIterations && !state.converged; ++k, ++state.iterations) {
      tissue.assemble(state.x, kStatic);
      const Eigen::VectorXd residual =
          share * gather_free(problem.force.data()) - gather_free(tissue.internal_force().data());
      state.converged = residual.norm() < 1e-8 * (tissue.internal_force().norm() + problem.force.norm());
      if (state.converged) break;
      const Solver solver(extract(tissue.system_matrix(), number, n_free));
      const Eigen::VectorXd step = solver.solve(residual);
      const double now = potential(state.x);
      double length = 1.0;
      while (length > 1e-6 && !(potential(move(step, length, state.x)) <= now + 1e-12 * std::abs(now))) length *= 0.5;
      state.x = move(step, length, state.x);
    }
    if (!state.converged) break;
  }
  tissue.assemble(state.x, kStatic);
  return state;
}

double compute_first_frequency(Tissue& tissue) {
  tissue.assemble(tissue.mesh().rest_positions, kStatic);
  const Solver solver(tissue.system_matrix());
  const Eigen::VectorXd M = to_dofs(tissue, tissue.mass().transpose().replicate<3, 1>());
  Eigen::VectorXd phi = to_dofs(tissue, Eigen::Vector3d(0.0, 0.0, 1.0).replicate(1, tissue.mesh().n_nodes()));
  double lambda = 0.0;
  for (int k = 0; k < 30; ++k) {
    const Eigen::VectorXd next = solver.solve(M.cwiseProduct(phi));
    lambda = phi.dot(M.cwiseProduct(phi)) / phi.dot(M.cwiseProduct(next));
    phi = next / next.norm();
  }
  return std::sqrt(lambda) / (2.0 * std::numbers::pi);
}

}  // namespace lipofill::solid::testing
