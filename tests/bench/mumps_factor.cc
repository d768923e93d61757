#include "tests/bench/mumps_factor.h"

#include <dmumps_c.h>
#include <smumps_c.h>

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace lipofill::bench {
namespace {

void call(DMUMPS_STRUC_C& id) {
  dmumps_c(&id);
}
void call(SMUMPS_STRUC_C& id) {
  smumps_c(&id);
}

template <typename Real>
using Struc = std::conditional_t<std::is_same_v<Real, double>, DMUMPS_STRUC_C, SMUMPS_STRUC_C>;

enum Job { kBegin = -1, kEnd = -2, kAnalyse = 1, kFactorise = 2, kSolve = 3 };

}  // namespace

template <typename Real>
struct MumpsFactor<Real>::Impl {
  Struc<Real> id = {};
  std::vector<int> rows, columns, position, schur_unknowns;
  std::vector<Real> values, right_side, schur, reduced;

  /// ICNTL as numbered in MUMPS' guide.
  int& control(int number) { return id.icntl[number - 1]; }
  void run(Job job) {
    id.job = job;
    call(id);
  }
};

template <typename Real>
MumpsFactor<Real>::MumpsFactor(const Eigen::SparseMatrix<double>& lower, const std::vector<int>& order, int n_schur)
    : impl_(std::make_unique<Impl>()) {
  constexpr int kGeneralSymmetric = 2, kUseSequentialMpi = -987654;
  constexpr int kGivenOrder = 1, kAutomaticOrder = 7, kSpareMemoryPercent = 50;
  Impl& impl = *impl_;
  impl.id.par = 1;
  impl.id.sym = kGeneralSymmetric;
  impl.id.comm_fortran = kUseSequentialMpi;
  impl.run(kBegin);
  for (int output = 1; output <= 4; ++output) impl.control(output) = 0;
  impl.control(6) = 0;   // no permutation to the diagonal
  impl.control(8) = 0;   // no scaling: without pivoting it changes nothing
  impl.control(12) = 1;  // the usual ordering, of unknowns one by one
  impl.control(14) = kSpareMemoryPercent;
  impl.id.cntl[0] = 0;  // no pivoting: the matrix is quasi-definite

  for (int column = 0; column < lower.cols(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it) {
      impl.rows.push_back(static_cast<int>(it.row()) + 1);
      impl.columns.push_back(column + 1);
    }
  }
  impl.values.resize(impl.rows.size());
  impl.id.n = static_cast<int>(lower.cols());
  impl.id.nnz = static_cast<int64_t>(impl.rows.size());
  impl.id.irn = impl.rows.data();
  impl.id.jcn = impl.columns.data();
  impl.id.a = impl.values.data();
  impl.control(7) = order.empty() ? kAutomaticOrder : kGivenOrder;
  impl.position.resize(order.size());
  for (size_t k = 0; k < order.size(); ++k) impl.position[order[k]] = static_cast<int>(k) + 1;
  impl.id.perm_in = impl.position.data();
  if (n_schur > 0) {
    for (int k = 0; k < n_schur; ++k) impl.schur_unknowns.push_back(impl.id.n - n_schur + k + 1);
    impl.schur.resize(static_cast<size_t>(n_schur) * n_schur);
    impl.reduced.resize(n_schur);
    impl.control(19) = 1;
    impl.id.size_schur = n_schur;
    impl.id.listvar_schur = impl.schur_unknowns.data();
    impl.id.schur = impl.schur.data();
    impl.id.redrhs = impl.reduced.data();
    impl.id.lredrhs = n_schur;
  }
  impl.run(kAnalyse);
}

template <typename Real>
MumpsFactor<Real>::~MumpsFactor() {
  impl_->run(kEnd);
}

template <typename Real>
absl::Status MumpsFactor<Real>::factorise(const Eigen::SparseMatrix<double>& lower) {
  Impl& impl = *impl_;
  std::copy(lower.valuePtr(), lower.valuePtr() + lower.nonZeros(), impl.values.begin());
  impl.run(kFactorise);
  if (impl.id.infog[0] >= 0) return absl::OkStatus();
  return absl::InternalError(absl::StrCat("MUMPS cannot factor the matrix: ", impl.id.infog[0]));
}

template <typename Real>
Eigen::VectorXd MumpsFactor<Real>::solve(const Eigen::VectorXd& right_side) {
  Impl& impl = *impl_;
  impl.right_side.assign(right_side.begin(), right_side.end());
  impl.id.rhs = impl.right_side.data();
  impl.run(kSolve);
  return Eigen::Map<Eigen::Matrix<Real, Eigen::Dynamic, 1>>(impl.right_side.data(), impl.id.n).template cast<double>();
}

/// By rows, its lower triangle.
template <typename Real>
Eigen::MatrixXd MumpsFactor<Real>::schur_complement() const {
  using Rows = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int n = impl_->id.size_schur;
  const Eigen::MatrixXd lower = Eigen::Map<const Rows>(impl_->schur.data(), n, n).template cast<double>();
  return lower.template selfadjointView<Eigen::Lower>();
}

template <typename Real>
Eigen::VectorXd MumpsFactor<Real>::condense(const Eigen::VectorXd& right_side) {
  impl_->control(26) = 1;
  solve(right_side);
  return Eigen::Map<Eigen::Matrix<Real, Eigen::Dynamic, 1>>(impl_->reduced.data(), impl_->id.size_schur)
      .template cast<double>();
}

template <typename Real>
Eigen::VectorXd MumpsFactor<Real>::expand(const Eigen::VectorXd& schur_solution) {
  Impl& impl = *impl_;
  std::copy(schur_solution.begin(), schur_solution.end(), impl.reduced.begin());
  impl.control(26) = 2;
  impl.run(kSolve);
  return Eigen::Map<Eigen::Matrix<Real, Eigen::Dynamic, 1>>(impl.right_side.data(), impl.id.n).template cast<double>();
}

template class MumpsFactor<double>;
template class MumpsFactor<float>;

}  // namespace lipofill::bench
