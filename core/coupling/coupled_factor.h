#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <optional>

#include "core/coupling/factor_analysis.h"
#include "core/coupling/supernodal_factor.h"

namespace lipofill::coupling {

enum class Precision { kSingle, kDouble };

/// Solves with the tissue's S and what it gives the films: the compliance C = B S^-1 B^T.
///
/// The dense route, for an analysis with pressures in it, has C at hand from the factorisation
/// (supernodal_factor.h) and takes the two halves of a solve apart: forward for the gap's response,
/// backward for the displacement once the pressure is known. The implicit route, for an analysis of
/// S alone, has no C, only its product with a vector: one solve each.
///
/// In float32 solutions are good to about 1e-6 relative on faces: enough for a left side, whose
/// errors the next iteration makes good; float64 is there for tissue that has no positive pivots in
/// float32. Decision record: core/doc/decisions/009-single-precision-factor.md.
/// Checked by tests/unit/coupling/coupled_factor_test.cc against dense references.
class CoupledFactor {
 public:
  explicit CoupledFactor(std::shared_ptr<const FactorAnalysis> analysis);

  /// Factors S with the films' B, in the patterns that were analysed. False when it is not positive
  /// definite in that precision; the factor is then not usable.
  bool factorise(const Eigen::SparseMatrix<double>& s, const Eigen::SparseMatrix<double>& b, Precision precision);

  /// B of the last factorise [m2] (n_cells, n_dofs).
  const Eigen::SparseMatrix<double>& derivative() const { return derivative_; }
  const FactorAnalysis& analysis() const { return *analysis_; }
  bool has_compliance() const { return analysis_->n_cells() > 0; }
  /// C of the last factorise [m3/Pa] (n_cells, n_cells), symmetric. Dense route only.
  const Eigen::MatrixXd& compliance() const { return compliance_; }
  /// C 1, the gap's response to a pressure everywhere [m3/Pa] (n_cells).
  const Eigen::VectorXd& lumped_compliance() const { return lumped_; }
  /// C p of the implicit route.
  void multiply_compliance(const Eigen::VectorXd& p, Eigen::VectorXd& product);

  /// Returns B S^-1 r; remembers r for solve_displacement.
  void solve_gap_response(const Eigen::VectorXd& r, Eigen::VectorXd& gap_response);
  /// dx = S^-1 (r + B^T p) with the r of the last solve_gap_response.
  void solve_displacement(const Eigen::VectorXd& pressure, Eigen::VectorXd& dx);

  /// x = S^-1 r, a solve of its own: no gap, no pressure.
  void solve(const Eigen::VectorXd& r, Eigen::VectorXd& x);
  /// X = S^-1 R for several right sides at once (n_dofs, n). A column of X depends on its own of R
  /// alone; it differs from that of solve() by round-off.
  void solve_many(const Eigen::MatrixXd& r, Eigen::MatrixXd& x);

 private:
  template <typename Visit>
  void with_factor(Visit visit);

  std::shared_ptr<const FactorAnalysis> analysis_;
  std::unique_ptr<SupernodalFactor<float>> single_;
  std::unique_ptr<SupernodalFactor<double>> double_;
  bool is_single_ = true;
  Eigen::SparseMatrix<double> derivative_;
  Eigen::MatrixXd compliance_;
  Eigen::VectorXd lumped_;
  Eigen::VectorXd nothing_;   ///< no pressures
  Eigen::VectorXd ignored_;   ///< the gap's response where nobody asks for it
  Eigen::VectorXd of_force_;  ///< S^-1 r of the implicit route
  Eigen::VectorXd right_side_;
  Eigen::VectorXd solution_;
};

}  // namespace lipofill::coupling
