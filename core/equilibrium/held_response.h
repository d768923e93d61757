#pragma once

#include <Eigen/Core>
#include <map>

#include "core/equilibrium/shape.h"
#include "core/equilibrium/static_balance.h"
#include "core/mechanics/tissue_factor.h"

namespace lipofill::equilibrium {

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
  /// @param missing  what each row's gap lacks [m3]; for a pool at the limit what its pressure lacks [Pa]
  bool correct(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& missing, Eigen::VectorXd& dx,
               Eigen::VectorXd& dp) {
    return answer(balance, shape, balance.force(), missing, dx, dp);
  }
  /// The same for an r that is given [N] (n_dofs).
  bool answer(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& force,
              const Eigen::VectorXd& missing, Eigen::VectorXd& dx, Eigen::VectorXd& dp);
  /// The same for forces in balance: r = 0.
  bool correct_volumes(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& missing,
                       Eigen::VectorXd& dx, Eigen::VectorXd& dp);

 private:
  void gather_columns(const Shape& shape);
  const Eigen::VectorXd& column_of_cell(int cell);
  bool solve_rows(const StaticBalance& balance, const Shape& shape, const Eigen::VectorXd& right,
                  const Eigen::VectorXd& missing, Eigen::VectorXd& dp);

  mechanics::TissueFactor& factor_;
  const Pools& pools_;
  Eigen::Matrix3Xd factored_at_;              ///< empty: there is no factor
  Eigen::SparseMatrix<double> derivative_;    ///< B there
  Eigen::MatrixXd of_pools_;                  ///< S0^-1 A0^T of the pools (n_dofs, n)
  std::map<int, Eigen::VectorXd> of_closed_;  ///< the same of closed cells, made when one closes
  Eigen::MatrixXd columns_;                   ///< of the rows of the shape at hand
};

}  // namespace lipofill::equilibrium
