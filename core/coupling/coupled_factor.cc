#include "core/coupling/coupled_factor.h"

#include <utility>

namespace lipofill::coupling {

using Sparse = Eigen::SparseMatrix<double>;

CoupledFactor::CoupledFactor(std::shared_ptr<const FactorAnalysis> analysis) : analysis_(std::move(analysis)) {}

template <typename Visit>
void CoupledFactor::with_factor(Visit visit) {
  if (is_single_) {
    visit(*single_);
  } else {
    visit(*double_);
  }
}

bool CoupledFactor::factorise(const Sparse& s, const Sparse& b, Precision precision) {
  is_single_ = precision == Precision::kSingle;
  if (is_single_ && single_ == nullptr) single_ = std::make_unique<SupernodalFactor<float>>(analysis_);
  if (!is_single_ && double_ == nullptr) double_ = std::make_unique<SupernodalFactor<double>>(analysis_);
  derivative_ = b;
  bool is_positive = false;
  with_factor([&](auto& factor) {
    is_positive = factor.factorise(s, b);
    if (is_positive && has_compliance()) factor.compute_compliance(compliance_);
  });
  if (!is_positive) return false;
  if (has_compliance()) {
    lumped_.noalias() = compliance_.rowwise().sum();
  } else if (b.rows() > 0) {
    multiply_compliance(Eigen::VectorXd::Ones(b.rows()), lumped_);
  }
  return true;
}

void CoupledFactor::multiply_compliance(const Eigen::VectorXd& p, Eigen::VectorXd& product) {
  right_side_.noalias() = derivative_.transpose() * p;
  with_factor([&](auto& factor) {
    factor.solve_forward(right_side_, nothing_);
    factor.solve_backward(nothing_, solution_);
  });
  product.noalias() = derivative_ * solution_;
}

void CoupledFactor::solve_gap_response(const Eigen::VectorXd& r, Eigen::VectorXd& gap_response) {
  with_factor([&](auto& factor) {
    factor.solve_forward(r, gap_response);
    if (!has_compliance()) factor.solve_backward(nothing_, of_force_);
  });
  if (!has_compliance()) gap_response.noalias() = derivative_ * of_force_;
}

void CoupledFactor::solve_displacement(const Eigen::VectorXd& pressure, Eigen::VectorXd& dx) {
  if (has_compliance()) {
    with_factor([&](auto& factor) { factor.solve_backward(pressure, dx); });
    return;
  }
  right_side_.noalias() = derivative_.transpose() * pressure;
  with_factor([&](auto& factor) {
    factor.solve_forward(right_side_, nothing_);
    factor.solve_backward(nothing_, dx);
  });
  dx += of_force_;
}

void CoupledFactor::solve(const Eigen::VectorXd& r, Eigen::VectorXd& x) {
  nothing_.setZero(analysis_->n_cells());
  with_factor([&](auto& factor) {
    factor.solve_forward(r, ignored_);
    factor.solve_backward(nothing_, x);
  });
}

void CoupledFactor::solve_many(const Eigen::MatrixXd& r, Eigen::MatrixXd& x) {
  with_factor([&](auto& factor) { factor.solve_many(r, x); });
}

}  // namespace lipofill::coupling
