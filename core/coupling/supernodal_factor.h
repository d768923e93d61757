#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "core/coupling/factor_analysis.h"

namespace lipofill::coupling {

/// L11, L21 and C of FactorAnalysis in float32 or float64: left-looking, supernode by supernode, on
/// BLAS. The matrix is scaled to a unit diagonal, so that units and contrasts of stiffness cost no
/// digits. C is a sum of squares, without cancellation.
///
/// Sums in a fixed order on the calling thread. Checked by
/// tests/unit/coupling/coupled_factor_test.cc against dense algebra and CHOLMOD.
template <typename Scalar>
class SupernodalFactor {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  explicit SupernodalFactor(std::shared_ptr<const FactorAnalysis> analysis);

  /// Computes the factor. False when a pivot is not positive in this precision; the factor is then
  /// not usable.
  bool factorise(const Eigen::SparseMatrix<double>& s, const Eigen::SparseMatrix<double>& b);

  /// C (n_cells, n_cells), symmetric.
  void compute_compliance(Eigen::MatrixXd& compliance);

  /// Half a solve: leaves y = L11^-1 r for the other half and returns B S^-1 r = L21 y.
  void solve_forward(const Eigen::VectorXd& r, Eigen::VectorXd& gap_response);
  /// The other half: x = S^-1 (r + B^T p) = L11^-T (y + L21^T p), with the y that solve_forward
  /// left.
  void solve_backward(const Eigen::VectorXd& pressure, Eigen::VectorXd& x);

  /// X = S^-1 R for several right sides at once (n_dofs, n), at a fraction of the time of as many
  /// solves. Each column of X depends on its own of R alone, down to the bits.
  void solve_many(const Eigen::MatrixXd& r, Eigen::MatrixXd& x);

 private:
  using Supernode = FactorAnalysis::Supernode;
  bool fill(const Eigen::SparseMatrix<double>& s, const Eigen::SparseMatrix<double>& b);
  void add_square(const Supernode& node);
  void gather_pressure_rows(const Supernode& node, int first, int count, int at);
  void add_gathered_squares(int& n_gathered);
  void subtract_update(const Supernode& target, const FactorAnalysis::Update& update);
  void solve_many_forward(int n_groups);
  void solve_many_backward(int n_groups);
  Scalar* values_of(const Supernode& node) { return values_.data() + node.values; }

  std::shared_ptr<const FactorAnalysis> analysis_;
  std::vector<Scalar> values_;
  std::vector<Scalar> buffer_;  ///< holds one update, or one supernode's rows
  std::vector<Scalar> square_;  ///< holds one supernode's product of its pressure rows
  Matrix gathered_;             ///< pressure rows of several supernodes (n_cells, kGatheredColumns)
  Matrix sum_;                  ///< C, scaled, lower triangle
  std::vector<int> position_;   ///< the supernode under way has each row of L there
  std::vector<int> relative_;   ///< positions of an update's rows
  Eigen::VectorXd scale_;       ///< every degree of freedom has one
  double pressure_scale_ = 1.0;
  Vector forward_;  ///< y, and below it L21 y
  Vector solution_;
  std::vector<Scalar> many_;         ///< right sides by groups of PanelSolveMany::kWidth, each row by row
  std::vector<Scalar> many_buffer_;  ///< one supernode's rows of a group
};

extern template class SupernodalFactor<float>;
extern template class SupernodalFactor<double>;

}  // namespace lipofill::coupling
