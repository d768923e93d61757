#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"

namespace lipofill::coupling {

/// Analysis, from the pattern alone, of the factorisation
///
///     [ S  B^T ]   [ L11   0 ] [ L11^T  L21^T ]
///     [ B   0  ] = [ L21   I ] [   0     -C   ],      C = L21 L21^T = B S^-1 B^T
///
/// with the degrees of freedom in a fill-reducing order and the pressures last: CHOLMOD's
/// supernodal analysis, cut where the pressures begin. Immutable, made once a model and plan, and
/// shared by all simulations of it. Checked by tests/unit/coupling/coupled_factor_test.cc.
class FactorAnalysis {
 public:
  /// Columns of L that share their rows below the diagonal: a dense panel (n_rows, n_columns),
  /// column-major, its first n_columns rows the triangle on the diagonal.
  struct Supernode {
    int first_column = 0;
    int n_columns = 0;
    int n_rows = 0;           ///< the triangle's are counted too
    int n_tissue_rows = 0;    ///< so many are degrees of freedom; the rest are pressures
    std::int64_t rows = 0;    ///< first of its rows in rows()
    std::int64_t values = 0;  ///< first of its values
  };
  /// Rows [begin, end) of `source` that are columns of the supernode it is listed for.
  struct Update {
    int source = 0;
    int begin = 0;
    int end = 0;
  };

  /// @param s  pattern of the lower triangle of S (n_dofs, n_dofs), columns and rows ascending
  /// @param b  pattern of B (n_cells, n_dofs); no rows: S alone
  /// RESOURCE_EXHAUSTED when CHOLMOD cannot analyse it in memory.
  static absl::StatusOr<std::shared_ptr<const FactorAnalysis>> create(const Eigen::SparseMatrix<double>& s,
                                                                      const Eigen::SparseMatrix<double>& b);

  int n_dofs() const { return n_dofs_; }
  int n_cells() const { return n_cells_; }
  /// Number of values of L11 and L21, fill and padding included.
  std::int64_t n_values() const { return n_values_; }
  /// Number of operations of one factorisation, C included; additions and multiplications are
  /// counted apart.
  double operations() const { return operations_; }

  /// Degree of freedom of each row of L11.
  const std::vector<int>& order() const { return order_; }
  const std::vector<Supernode>& supernodes() const { return supernodes_; }
  /// Rows of all supernodes, ascending in each: place in order(), or n_dofs + cell.
  const std::vector<int>& rows() const { return rows_; }
  const std::vector<Update>& updates(int supernode) const { return updates_[supernode]; }
  /// Place in L of each value of S and of B.
  const std::vector<std::int64_t>& target_of_s() const { return target_of_s_; }
  const std::vector<std::int64_t>& target_of_b() const { return target_of_b_; }
  int max_rows() const { return max_rows_; }
  int max_columns() const { return max_columns_; }

 private:
  FactorAnalysis() = default;
  void list_updates();
  void place_values(const Eigen::SparseMatrix<double>& s, const Eigen::SparseMatrix<double>& b);

  int n_dofs_ = 0;
  int n_cells_ = 0;
  int max_rows_ = 0;
  int max_columns_ = 0;
  std::int64_t n_values_ = 0;
  double operations_ = 0.0;
  std::vector<int> order_;
  std::vector<Supernode> supernodes_;
  std::vector<int> rows_;
  std::vector<std::vector<Update>> updates_;
  std::vector<std::int64_t> target_of_s_, target_of_b_;
  friend class CholmodAnalysis;
};

}  // namespace lipofill::coupling
