#include "core/coupling/coupled_factor.h"

#include <cholmod.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "absl/strings/str_cat.h"

extern "C" void openblas_set_num_threads(int n_threads);

namespace lipofill::coupling {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// A shift this many times the norm of C loses less than two digits; below half of it, drift of C could overtake the
/// shift.
constexpr double kShiftOverNorm = 4.0;
constexpr double kShiftGrowth = 16.0;
constexpr int kMaxShiftTries = 24;

/// Debian's CHOLMOD opens OpenMP regions of four threads for copying loops, and OpenBLAS threads of its own; sessions
/// are the project's parallelism, one thread each. The first setting is a thread's own, the second the process's.
void keep_algebra_on_this_thread() {
  omp_set_max_active_levels(0);
  static const bool once = [] {
    openblas_set_num_threads(1);
    return true;
  }();
  static_cast<void>(once);
}

}  // namespace

struct CoupledFactor::Impl {
  int n_dofs = 0;
  int n_cells = 0;
  double shift = 0.0;
  cholmod_common common;
  cholmod_sparse* matrix = nullptr;  ///< lower triangle of the augmented matrix
  cholmod_factor* factor = nullptr;
  cholmod_dense *right_side = nullptr, *solution = nullptr, *work_y = nullptr, *work_e = nullptr;
  std::vector<int> value_of_s, value_of_b, value_of_diagonal;  ///< where the entries go in matrix->x
  std::vector<int> cell_of_last;                               ///< cell of each of the factor's last columns
  Eigen::MatrixXd last_block;                                  ///< L22, in the factor's order
  Eigen::MatrixXd compliance;

  Impl() {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.print = 0;
    common.error_handler = nullptr;
  }
  ~Impl() {
    cholmod_free_dense(&right_side, &common);
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&work_y, &common);
    cholmod_free_dense(&work_e, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&matrix, &common);
    cholmod_finish(&common);
  }

  void build_pattern(const Sparse& s, const Sparse& b);
  void analyse(const Sparse& s);
  void fill(const Sparse& s, const Sparse& b);
  bool try_factor();
  void choose_first_shift(const Sparse& s, const Sparse& b);
  void extract_last_block();
  Eigen::VectorXd solve(const Eigen::VectorXd& top, const Eigen::VectorXd& bottom);
};

void CoupledFactor::Impl::build_pattern(const Sparse& s, const Sparse& b) {
  const int n = n_dofs + n_cells;
  matrix = cholmod_allocate_sparse(n, n, s.nonZeros() + b.nonZeros() + n_cells, 1, 1, -1, CHOLMOD_REAL, &common);
  int* columns = static_cast<int*>(matrix->p);
  int* rows = static_cast<int*>(matrix->i);
  int next = 0;
  for (int column = 0; column < n_dofs; ++column) {
    columns[column] = next;
    for (Sparse::InnerIterator it(s, column); it; ++it) {
      value_of_s.push_back(next);
      rows[next++] = static_cast<int>(it.row());
    }
    for (Sparse::InnerIterator it(b, column); it; ++it) {
      value_of_b.push_back(next);
      rows[next++] = n_dofs + static_cast<int>(it.row());
    }
  }
  for (int cell = 0; cell < n_cells; ++cell) {
    columns[n_dofs + cell] = next;
    value_of_diagonal.push_back(next);
    rows[next++] = n_dofs + cell;
  }
  columns[n] = next;
}

/// Orders S alone by nested dissection or minimum degree, whichever CHOLMOD finds better, and appends the pressures.
void CoupledFactor::Impl::analyse(const Sparse& s) {
  Sparse copy = s;
  cholmod_sparse tissue = {};
  tissue.nrow = tissue.ncol = n_dofs;
  tissue.nzmax = copy.nonZeros();
  tissue.p = copy.outerIndexPtr();
  tissue.i = copy.innerIndexPtr();
  tissue.stype = -1;
  tissue.itype = CHOLMOD_INT;
  tissue.xtype = CHOLMOD_PATTERN;
  tissue.sorted = tissue.packed = 1;
  cholmod_factor* tissue_factor = cholmod_analyze(&tissue, &common);
  if (tissue_factor == nullptr) return;
  std::vector<int> order(static_cast<int*>(tissue_factor->Perm), static_cast<int*>(tissue_factor->Perm) + n_dofs);
  cholmod_free_factor(&tissue_factor, &common);
  for (int cell = 0; cell < n_cells; ++cell) order.push_back(n_dofs + cell);

  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_GIVEN;
  const auto pressures_are_last = [&] {
    const int* order_used = static_cast<int*>(factor->Perm);
    return std::all_of(order_used + n_dofs, order_used + n_dofs + n_cells, [&](int k) { return k >= n_dofs; });
  };
  factor = cholmod_analyze_p(matrix, order.data(), nullptr, 0, &common);
  if (factor != nullptr && !pressures_are_last()) {
    // Postordering may move pressures forward when the tissue falls into pieces; the order given is valid as it is.
    cholmod_free_factor(&factor, &common);
    common.postorder = 0;
    factor = cholmod_analyze_p(matrix, order.data(), nullptr, 0, &common);
  }
  if (factor == nullptr) return;
  const int* order_used = static_cast<int*>(factor->Perm);
  for (int k = 0; k < n_cells; ++k) cell_of_last.push_back(order_used[n_dofs + k] - n_dofs);
}

void CoupledFactor::Impl::fill(const Sparse& s, const Sparse& b) {
  double* values = static_cast<double*>(matrix->x);
  for (size_t k = 0; k < value_of_s.size(); ++k) values[value_of_s[k]] = s.valuePtr()[k];
  for (size_t k = 0; k < value_of_b.size(); ++k) values[value_of_b[k]] = b.valuePtr()[k];
}

bool CoupledFactor::Impl::try_factor() {
  double* values = static_cast<double*>(matrix->x);
  for (const int k : value_of_diagonal) values[k] = shift;
  cholmod_factorize(matrix, factor, &common);
  return common.status == CHOLMOD_OK && static_cast<int>(factor->minor) == n_dofs + n_cells;
}

/// A lower bound of the norm of C from the diagonal of S; tries from there upwards find the right order of magnitude.
void CoupledFactor::Impl::choose_first_shift(const Sparse& s, const Sparse& b) {
  Eigen::VectorXd diagonal_compliance = Eigen::VectorXd::Zero(n_cells);
  for (int column = 0; column < n_dofs; ++column) {
    const double stiffness = s.coeff(column, column);
    for (Sparse::InnerIterator it(b, column); it; ++it) {
      diagonal_compliance[it.row()] += it.value() * it.value() / stiffness;
    }
  }
  shift = n_cells == 0 ? 1.0 : kShiftOverNorm * diagonal_compliance.maxCoeff();
}

/// L22 and from it C = e I - L22 L22^T.
void CoupledFactor::Impl::extract_last_block() {
  const int* super = static_cast<int*>(factor->super);
  const int* row_start = static_cast<int*>(factor->pi);
  const int* value_start = static_cast<int*>(factor->px);
  const int* rows = static_cast<int*>(factor->s);
  const double* values = static_cast<double*>(factor->x);
  last_block.setZero(n_cells, n_cells);
  for (int node = static_cast<int>(factor->nsuper) - 1; node >= 0 && super[node + 1] > n_dofs; --node) {
    const int n_rows = row_start[node + 1] - row_start[node];
    for (int column = std::max(super[node], n_dofs); column < super[node + 1]; ++column) {
      const int k = column - super[node];
      const double* column_values = values + value_start[node] + static_cast<ptrdiff_t>(k) * n_rows;
      for (int r = k; r < n_rows; ++r) {
        last_block(rows[row_start[node] + r] - n_dofs, column - n_dofs) = column_values[r];
      }
    }
  }
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(n_cells, n_cells);
  product.selfadjointView<Eigen::Lower>().rankUpdate(last_block);
  compliance.resize(n_cells, n_cells);
  for (int b = 0; b < n_cells; ++b) {
    for (int a = b; a < n_cells; ++a) {
      const double value = (a == b ? shift : 0.0) - product(a, b);
      compliance(cell_of_last[a], cell_of_last[b]) = compliance(cell_of_last[b], cell_of_last[a]) = value;
    }
  }
}

Eigen::VectorXd CoupledFactor::Impl::solve(const Eigen::VectorXd& top, const Eigen::VectorXd& bottom) {
  if (right_side == nullptr)
    right_side = cholmod_allocate_dense(n_dofs + n_cells, 1, n_dofs + n_cells, CHOLMOD_REAL, &common);
  Eigen::Map<Eigen::VectorXd> b(static_cast<double*>(right_side->x), n_dofs + n_cells);
  b << top, bottom;
  cholmod_solve2(CHOLMOD_A, factor, right_side, nullptr, &solution, nullptr, &work_y, &work_e, &common);
  return Eigen::Map<Eigen::VectorXd>(static_cast<double*>(solution->x), n_dofs + n_cells);
}

CoupledFactor::CoupledFactor(const Sparse& s, const Sparse& b) : impl_(std::make_unique<Impl>()) {
  keep_algebra_on_this_thread();
  impl_->n_dofs = static_cast<int>(s.cols());
  impl_->n_cells = static_cast<int>(b.rows());
  impl_->build_pattern(s, b);
  impl_->analyse(s);
}

CoupledFactor::~CoupledFactor() = default;

double CoupledFactor::factor_bytes() const {
  if (impl_->factor == nullptr) return std::numeric_limits<double>::infinity();
  return static_cast<double>(impl_->factor->xsize) * sizeof(double);
}

absl::Status CoupledFactor::factorise(const Sparse& s, const Sparse& b) {
  Impl& impl = *impl_;
  keep_algebra_on_this_thread();
  impl.fill(s, b);
  const bool first = impl.shift <= 0.0;
  if (first) impl.choose_first_shift(s, b);
  bool done = impl.try_factor();
  for (int tries = 0; !done && tries < kMaxShiftTries; ++tries) {
    if (impl.common.status != CHOLMOD_OK && impl.common.status != CHOLMOD_NOT_POSDEF) break;
    if (static_cast<int>(impl.factor->minor) < impl.n_dofs) break;
    impl.shift *= kShiftGrowth;
    done = impl.try_factor();
  }
  if (!done) {
    return absl::InternalError(absl::StrCat("the tissue's stiffness cannot be factored: CHOLMOD status ",
                                            impl.common.status, ", pivot ", impl.factor->minor, " of ",
                                            impl.n_dofs + impl.n_cells));
  }
  if (impl.n_cells == 0) return absl::OkStatus();
  impl.extract_last_block();
  const double norm = impl.compliance.cwiseAbs().rowwise().sum().maxCoeff();
  const bool needless_digits_lost = impl.shift > kShiftGrowth * kShiftOverNorm * norm;
  if (needless_digits_lost) {
    impl.shift = kShiftOverNorm * norm;
    return factorise(s, b);
  }
  return absl::OkStatus();
}

const Eigen::MatrixXd& CoupledFactor::compliance() const {
  return impl_->compliance;
}

Eigen::VectorXd CoupledFactor::compute_gap_response(const Eigen::VectorXd& r) {
  // [S B^T; B e] [x; q] = [r; 0]  gives  (e - C) q = -B S^-1 r.
  Impl& impl = *impl_;
  const Eigen::VectorXd q = impl.solve(r, Eigen::VectorXd::Zero(impl.n_cells)).tail(impl.n_cells);
  return impl.compliance * q - impl.shift * q;
}

Eigen::VectorXd CoupledFactor::solve_displacement(const Eigen::VectorXd& r, const Eigen::VectorXd& gap_response,
                                                  const Eigen::VectorXd& pressure) {
  // With [r; B S^-1 r - (e - C) p] the second unknown is -p, and the first S^-1 (r + B^T p).
  Impl& impl = *impl_;
  const Eigen::VectorXd bottom = gap_response - impl.shift * pressure + impl.compliance * pressure;
  return impl.solve(r, bottom).head(impl.n_dofs);
}

double CoupledFactor::shift() const {
  return impl_->shift;
}
void CoupledFactor::set_shift(double shift) {
  impl_->shift = shift;
}

}  // namespace lipofill::coupling
