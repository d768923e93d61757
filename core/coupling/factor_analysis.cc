#include "core/coupling/factor_analysis.h"

#include <cholmod.h>

#include <algorithm>
#include <mutex>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/coupling/algebra_threads.h"
#include "core/coupling/thread_random.h"

namespace lipofill::coupling {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

cholmod_sparse view_pattern(Sparse& lower) {
  cholmod_sparse view = {};
  view.nrow = view.ncol = lower.cols();
  view.nzmax = lower.nonZeros();
  view.p = lower.outerIndexPtr();
  view.i = lower.innerIndexPtr();
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_PATTERN;
  view.sorted = view.packed = 1;
  return view;
}

/// Lower triangle of [S B^T; B I].
Sparse augment(const Sparse& s, const Sparse& b) {
  const Eigen::Index n_dofs = s.cols();
  const Eigen::Index n = n_dofs + b.rows();
  std::vector<int> columns = {0};
  std::vector<int> rows;
  rows.reserve(s.nonZeros() + b.nonZeros() + b.rows());
  for (int column = 0; column < n; ++column) {
    if (column < n_dofs) {
      for (Sparse::InnerIterator it(s, column); it; ++it) rows.push_back(static_cast<int>(it.row()));
      for (Sparse::InnerIterator it(b, column); b.rows() > 0 && it; ++it) {
        rows.push_back(static_cast<int>(n_dofs + it.row()));
      }
    } else {
      rows.push_back(column);
    }
    columns.push_back(static_cast<int>(rows.size()));
  }
  const std::vector<double> zeros(rows.size(), 0.0);
  return Eigen::Map<const Sparse>(n, n, static_cast<int>(rows.size()), columns.data(), rows.data(), zeros.data());
}

}  // namespace

/// CHOLMOD's workspace and the factor it has analysed.
class CholmodAnalysis {
 public:
  CholmodAnalysis() {
    pin_algebra_to_this_thread();
    cholmod_start(&common_);
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.print = 0;
    common_.error_handler = nullptr;
    // The better of two: minimum degree for small tissue, CHOLMOD's own nested dissection for all
    // else (on faces it saves a fifth of the operations of METIS's).
    common_.nmethods = 2;
    common_.method[0].ordering = CHOLMOD_AMD;
    common_.method[1].ordering = CHOLMOD_NESDIS;
  }
  ~CholmodAnalysis() {
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }
  CholmodAnalysis(const CholmodAnalysis&) = delete;
  CholmodAnalysis& operator=(const CholmodAnalysis&) = delete;

  /// Orders S alone and appends the pressures.
  bool analyse(const Sparse& s, const Sparse& b) {
    Sparse tissue = s;
    cholmod_sparse view = view_pattern(tissue);
    cholmod_factor* of_tissue = order_alone(view);
    if (of_tissue == nullptr) return false;
    const int* tissue_order = static_cast<int*>(of_tissue->Perm);
    std::vector<int> order(tissue_order, tissue_order + s.cols());
    cholmod_free_factor(&of_tissue, &common_);
    order.resize(s.cols() + b.rows());
    std::iota(order.begin() + s.cols(), order.end(), static_cast<int>(s.cols()));

    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_GIVEN;
    Sparse augmented = augment(s, b);
    cholmod_sparse augmented_view = view_pattern(augmented);
    factor_ = cholmod_analyze_p(&augmented_view, order.data(), nullptr, 0, &common_);
    if (factor_ != nullptr && !pressures_are_last(static_cast<int>(s.cols()))) {
      // Postordering may move pressures forward when the tissue falls into pieces; the order given
      // is valid as it is.
      cholmod_free_factor(&factor_, &common_);
      common_.postorder = 0;
      factor_ = cholmod_analyze_p(&augmented_view, order.data(), nullptr, 0, &common_);
    }
    return factor_ != nullptr;
  }

  std::string status() const { return absl::StrCat("CHOLMOD status ", common_.status); }

  /// Supernodes of the degrees of freedom, pressures numbered as cells are.
  void copy_to(FactorAnalysis& analysis) const {
    const int* order = static_cast<int*>(factor_->Perm);
    const int* first_column = static_cast<int*>(factor_->super);
    const int* row_start = static_cast<int*>(factor_->pi);
    const int* rows = static_cast<int*>(factor_->s);
    const int n_dofs = analysis.n_dofs_;
    analysis.order_.assign(order, order + n_dofs);
    for (size_t k = 0; k < factor_->nsuper && first_column[k] < n_dofs; ++k) {
      FactorAnalysis::Supernode node;
      node.first_column = first_column[k];
      node.n_columns = std::min(first_column[k + 1], n_dofs) - first_column[k];
      node.rows = static_cast<std::int64_t>(analysis.rows_.size());
      node.values = analysis.n_values_;
      for (int r = row_start[k]; r < row_start[k + 1]; ++r) {
        analysis.rows_.push_back(rows[r] < n_dofs ? rows[r] : order[rows[r]]);
        node.n_tissue_rows += static_cast<int>(rows[r] < n_dofs);
      }
      node.n_rows = row_start[k + 1] - row_start[k];
      std::sort(analysis.rows_.begin() + node.rows + node.n_tissue_rows, analysis.rows_.end());
      analysis.n_values_ += static_cast<std::int64_t>(node.n_rows) * node.n_columns;
      analysis.max_rows_ = std::max(analysis.max_rows_, node.n_rows);
      analysis.max_columns_ = std::max(analysis.max_columns_, node.n_columns);
      for (int c = 0; c < node.n_columns; ++c) {
        const double below = node.n_rows - c;
        analysis.operations_ += below * below;
      }
      analysis.supernodes_.push_back(node);
    }
  }

 private:
  /// Nested dissection bisects with METIS, which draws random numbers: see thread_random.h. Where
  /// it finds those of the whole process alone, orderings take turns.
  cholmod_factor* order_alone(cholmod_sparse& pattern) {
    static std::mutex one_at_a_time;
    std::unique_lock turn(one_at_a_time, std::defer_lock);
    if (!has_random_numbers_of_its_own()) turn.lock();
    return cholmod_analyze(&pattern, &common_);
  }

  bool pressures_are_last(int n_dofs) const {
    const int* order = static_cast<int*>(factor_->Perm);
    return std::all_of(order + n_dofs, order + factor_->n, [&](int k) { return k >= n_dofs; });
  }

  cholmod_common common_;
  cholmod_factor* factor_ = nullptr;
};

absl::StatusOr<std::shared_ptr<const FactorAnalysis>> FactorAnalysis::create(const Sparse& s, const Sparse& b) {
  CholmodAnalysis cholmod;
  if (!cholmod.analyse(s, b)) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the tissue's ", s.cols(), " degrees of freedom cannot be analysed: ", cholmod.status()));
  }
  std::shared_ptr<FactorAnalysis> analysis(new FactorAnalysis());
  analysis->n_dofs_ = static_cast<int>(s.cols());
  analysis->n_cells_ = static_cast<int>(b.rows());
  cholmod.copy_to(*analysis);
  analysis->list_updates();
  analysis->place_values(s, b);
  return analysis;
}

void FactorAnalysis::list_updates() {
  std::vector<int> supernode_of_column(n_dofs_);
  for (size_t k = 0; k < supernodes_.size(); ++k) {
    const auto first = supernode_of_column.begin() + supernodes_[k].first_column;
    std::fill(first, first + supernodes_[k].n_columns, static_cast<int>(k));
  }
  updates_.resize(supernodes_.size());
  for (size_t k = 0; k < supernodes_.size(); ++k) {
    const Supernode& node = supernodes_[k];
    const int* rows = rows_.data() + node.rows;
    for (int begin = node.n_columns; begin < node.n_tissue_rows;) {
      const int owner = supernode_of_column[rows[begin]];
      int end = begin + 1;
      while (end < node.n_tissue_rows && supernode_of_column[rows[end]] == owner) ++end;
      updates_[owner].push_back({static_cast<int>(k), begin, end});
      begin = end;
    }
  }
}

void FactorAnalysis::place_values(const Sparse& s, const Sparse& b) {
  std::vector<int> place(n_dofs_);
  for (int k = 0; k < n_dofs_; ++k) place[order_[k]] = k;
  std::vector<int> supernode_of_column(n_dofs_);
  for (size_t k = 0; k < supernodes_.size(); ++k) {
    const auto first = supernode_of_column.begin() + supernodes_[k].first_column;
    std::fill(first, first + supernodes_[k].n_columns, static_cast<int>(k));
  }
  const auto target = [&](int row, int column) {
    const Supernode& node = supernodes_[supernode_of_column[column]];
    const auto first = rows_.begin() + node.rows;
    const auto at = std::lower_bound(first, first + node.n_rows, row) - first;
    return node.values + static_cast<std::int64_t>(column - node.first_column) * node.n_rows + at;
  };
  target_of_s_.reserve(s.nonZeros());
  target_of_b_.reserve(b.nonZeros());
  for (int column = 0; column < n_dofs_; ++column) {
    for (Sparse::InnerIterator it(s, column); it; ++it) {
      const auto [low, high] = std::minmax(place[it.row()], place[column]);
      target_of_s_.push_back(target(high, low));
    }
    for (Sparse::InnerIterator it(b, column); n_cells_ > 0 && it; ++it) {
      target_of_b_.push_back(target(n_dofs_ + static_cast<int>(it.row()), place[column]));
    }
  }
}

}  // namespace lipofill::coupling
