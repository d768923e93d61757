#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <map>
#include <vector>

#include "core/equilibrium/shape.h"
#include "core/equilibrium/static_balance.h"
#include "core/mechanics/tissue_factor.h"

namespace lipofill::equilibrium {

/// A factor is of a shape far away where this share of the forces is left after a step with it.
inline constexpr double kFarShare = 0.2;

/// A question holds what HeldResponse is asked, and what it answers.
struct Question {
  const Shape* shape = nullptr;  ///< says which rows there are; none of its values is used
  Eigen::MatrixXd rows;          ///< A^T there [m2] (n_dofs, n_rows): find_rows
  Eigen::VectorXd force;         ///< r [N] (n_dofs)
  Eigen::VectorXd missing;       ///< what each row's gap lacks [m3], at the limit what its pressure lacks [Pa]
  bool is_answered = false;      ///< false: the rows depend on one another
  Eigen::VectorXd dx;            ///< [m] (n_dofs)
  Eigen::VectorXd dp;            ///< [Pa] (n_rows)
};

/// A^T of a shape (n_dofs, n_rows): the rows of B summed a pool, and those of closed cells.
Eigen::MatrixXd find_rows(const Eigen::SparseMatrix<double>& derivative, const Pools& pools, const Shape& shape);

/// A C of rows A^T (n_dofs, n_rows) and columns C. Where there are many, most are of a cell each,
/// and hardly any of their values differ from 0.
Eigen::MatrixXd multiply_rows(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& columns);

/// The answer of tissue and pools to what is out of balance, by a factor that may be of an earlier
/// shape: the solution of
///
///     S0 dx - A0^T dp = r         S0, A0: of the shape that was factored;  A0: rows of B summed a pool, and of
///     A  dx           = missing   closed cells;  r, A: of the shape as it is
///
/// by one solve with S0 and a Schur complement as small as there are rows. Pools at the suction
/// limit have dp given in place of their volume.
/// Checked by tests/unit/equilibrium/held_response_test.cc.
class HeldResponse {
 public:
  /// What is passed here outlives the response.
  HeldResponse(mechanics::TissueFactor& factor, const Pools& pools) : factor_(factor), pools_(pools) {}

  /// Factors where the balance is. False when the tissue is not positive definite there.
  bool renew(const StaticBalance& balance, const Eigen::VectorXd& springs);
  /// Begins without a factor.
  void forget() { factored_at_.resize(3, 0); }
  bool has_factor() const { return factored_at_.size() > 0; }
  /// True when the factor is of another shape than the balance.
  bool is_late(const StaticBalance& balance) const { return !mechanics::is_same(factored_at_, balance.positions()); }

  /// Solves for dx and dp with the balance's own r. False when the rows depend on one another.
  /// @param missing  as Question::missing
  bool correct(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& missing, Eigen::VectorXd& dx,
               Eigen::VectorXd& dp);
  /// The same for forces in balance: r = 0.
  bool correct_volumes(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& missing,
                       Eigen::VectorXd& dx, Eigen::VectorXd& dp);
  /// Answers several questions at once: they share the reading of the factor. An answer does not
  /// depend on the questions beside it.
  void answer(const std::vector<Question*>& questions);

  /// S0^-1 A0^T of the pools (n_dofs, n_pools).
  const Eigen::MatrixXd& of_pools() const { return of_pools_; }

 private:
  void gather_columns(const Shape& shape);
  const Eigen::VectorXd& column_of_cell(int cell);
  bool add_pressures(const Shape& shape, const Eigen::MatrixXd& rows, const Eigen::VectorXd& missing,
                     Eigen::VectorXd& dx, Eigen::VectorXd& dp);

  mechanics::TissueFactor& factor_;
  const Pools& pools_;
  Eigen::Matrix3Xd factored_at_;              ///< empty: there is no factor
  Eigen::SparseMatrix<double> derivative_;    ///< B there
  Eigen::MatrixXd of_pools_;                  ///< S0^-1 A0^T of the pools (n_dofs, n)
  std::map<int, Eigen::VectorXd> of_closed_;  ///< the same of closed cells, made when one closes
  Eigen::MatrixXd columns_;                   ///< of the rows of the shape at hand
};

}  // namespace lipofill::equilibrium
