#include "tests/bench/cholmod_factor.h"

#include <cholmod.h>

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace lipofill::bench {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// CHOLMOD reads the matrix and does not write to it.
cholmod_sparse view_of(const Sparse& lower) {
  cholmod_sparse view = {};
  view.nrow = view.ncol = lower.cols();
  view.nzmax = lower.nonZeros();
  view.p = const_cast<int*>(lower.outerIndexPtr());
  view.i = const_cast<int*>(lower.innerIndexPtr());
  view.x = const_cast<double*>(lower.valuePtr());
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = view.packed = 1;
  return view;
}

cholmod_dense view_of(const Eigen::MatrixXd& dense) {
  cholmod_dense view = {};
  view.nrow = view.d = dense.rows();
  view.ncol = dense.cols();
  view.nzmax = dense.size();
  view.x = const_cast<double*>(dense.data());
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  return view;
}

}  // namespace

struct CholmodFactor::Impl {
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  cholmod_dense *solution = nullptr, *work_y = nullptr, *work_e = nullptr;

  Impl() { cholmod_start(&common); }
  ~Impl() {
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&work_y, &common);
    cholmod_free_dense(&work_e, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
};

CholmodFactor::CholmodFactor(const Sparse& lower, Kind kind, std::vector<int> order) : impl_(std::make_unique<Impl>()) {
  cholmod_common& common = impl_->common;
  common.print = 0;
  common.supernodal = kind == Kind::kSupernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
  cholmod_sparse matrix = view_of(lower);
  if (order.empty()) {
    impl_->factor = cholmod_analyze(&matrix, &common);
    return;
  }
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_GIVEN;
  common.postorder = 0;  // what is last stays last
  impl_->factor = cholmod_analyze_p(&matrix, order.data(), nullptr, 0, &common);
}

CholmodFactor::~CholmodFactor() = default;

absl::Status CholmodFactor::factorise(const Sparse& lower) {
  cholmod_sparse matrix = view_of(lower);
  if (impl_->factor != nullptr) cholmod_factorize(&matrix, impl_->factor, &impl_->common);
  if (impl_->factor != nullptr && impl_->common.status == CHOLMOD_OK && impl_->factor->minor == impl_->factor->n) {
    return absl::OkStatus();
  }
  return absl::InternalError(absl::StrCat("CHOLMOD cannot factor the matrix: status ", impl_->common.status));
}

Eigen::Map<const Eigen::MatrixXd> CholmodFactor::solve(const Eigen::MatrixXd& right_sides) {
  Impl& impl = *impl_;
  cholmod_dense right = view_of(right_sides);
  cholmod_solve2(CHOLMOD_A, impl.factor, &right, nullptr, &impl.solution, nullptr, &impl.work_y, &impl.work_e,
                 &impl.common);
  return {static_cast<const double*>(impl.solution->x), right_sides.rows(), right_sides.cols()};
}

std::vector<int> CholmodFactor::order() const {
  const int* order = static_cast<const int*>(impl_->factor->Perm);
  return {order, order + impl_->factor->n};
}

Eigen::MatrixXd CholmodFactor::last_block(int n) const {
  const cholmod_factor& factor = *impl_->factor;
  const int* super = static_cast<const int*>(factor.super);
  const int* row_start = static_cast<const int*>(factor.pi);
  const int* value_start = static_cast<const int*>(factor.px);
  const int* rows = static_cast<const int*>(factor.s);
  const double* values = static_cast<const double*>(factor.x);
  const int first = static_cast<int>(factor.n) - n;
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(n, n);
  for (int node = static_cast<int>(factor.nsuper) - 1; node >= 0 && super[node + 1] > first; --node) {
    const int n_rows = row_start[node + 1] - row_start[node];
    for (int column = std::max(super[node], first); column < super[node + 1]; ++column) {
      const int k = column - super[node];
      const double* of_column = values + value_start[node] + static_cast<ptrdiff_t>(k) * n_rows;
      for (int r = k; r < n_rows; ++r) block(rows[row_start[node] + r] - first, column - first) = of_column[r];
    }
  }
  return block;
}

std::vector<int> order_with_more_last(const Sparse& lower, int n_more) {
  std::vector<int> order = CholmodFactor(lower, CholmodFactor::Kind::kSupernodal).order();
  const int n = static_cast<int>(order.size());
  for (int k = 0; k < n_more; ++k) order.push_back(n + k);
  return order;
}

}  // namespace lipofill::bench
