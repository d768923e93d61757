#include "tests/bench/pressure_cg.h"

#include "tests/bench/route.h"

namespace lipofill::bench {
namespace {

using Eigen::VectorXd;

constexpr int kMaxIterations = 500;
/// C has negative entries on curved layers; a lumped cell keeps this share of the largest, so that
/// J + R is definite.
constexpr double kLeastShare = 1e-6;

VectorXd times_compliance(const LinearStep& step, CholmodFactor& factor, const VectorXd& p) {
  return step.b * VectorXd(factor.solve(step.b.transpose() * p));
}

using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// f - S dx + B^T p and d - B dx - J p, summed in extended precision.
LinearAnswer compute_residual(const LinearStep& step, const LinearAnswer& x) {
  const auto wide = [](const Eigen::SparseMatrix<double>& matrix) { return matrix.cast<long double>(); };
  const LongVector dx = x.displacement.cast<long double>();
  const LongVector p = x.pressure.cast<long double>();
  const Eigen::SparseMatrix<long double> s = wide(step.s), b = wide(step.b), j = wide(step.j);
  const LongVector of_tissue = step.f.cast<long double>() - s.selfadjointView<Eigen::Lower>() * dx + b.transpose() * p;
  const LongVector of_film = step.d.cast<long double>() - b * dx - j * p;
  return {of_tissue.cast<double>(), of_film.cast<double>()};
}

}  // namespace

void PressureCg::prepare(const LinearStep& step, CholmodFactor& factor) {
  VectorXd lumped = times_compliance(step, factor, VectorXd::Ones(step.n_cells()));
  lumped = lumped.cwiseMax(kLeastShare * lumped.maxCoeff());
  Eigen::SparseMatrix<double> matrix = step.j;
  for (int cell = 0; cell < step.n_cells(); ++cell) matrix.coeffRef(cell, cell) += lumped[cell];
  preconditioner_.factorize(matrix);
}

VectorXd PressureCg::solve(const LinearStep& step, CholmodFactor& factor, const VectorXd& r) {
  prepare(step, factor);
  VectorXd p = VectorXd::Zero(r.size()), residual = r;
  VectorXd z = preconditioner_.solve(residual), direction = z;
  double rz = residual.dot(z);
  const double goal = tolerance_ * tolerance_ * rz;
  for (iterations_ = 0; iterations_ < kMaxIterations && rz > goal; ++iterations_) {
    const VectorXd image = step.j * direction + times_compliance(step, factor, direction);
    const double length = rz / direction.dot(image);
    p += length * direction;
    residual -= length * image;
    z = preconditioner_.solve(residual);
    const double last = rz;
    rz = residual.dot(z);
    direction = z + (rz / last) * direction;
  }
  return p;
}

absl::StatusOr<LinearAnswer> compute_reference(const LinearStep& step) {
  constexpr int kCorrections = 3;
  CholmodFactor factor(step.s, CholmodFactor::Kind::kSupernodal);
  if (const absl::Status status = factor.factorise(step.s); !status.ok()) return status;
  PressureCg cg(step);
  LinearAnswer x{VectorXd::Zero(step.n_dofs()), VectorXd::Zero(step.n_cells())};
  for (int round = 0; round < kCorrections; ++round) {
    const LinearAnswer r = compute_residual(step, x);
    const VectorXd response = step.b * VectorXd(factor.solve(r.displacement));
    const VectorXd p = cg.solve(step, factor, r.pressure - response);
    x.displacement += VectorXd(factor.solve(r.displacement + step.b.transpose() * p));
    x.pressure += p;
  }
  return x;
}

}  // namespace lipofill::bench
