#pragma once

#include <Eigen/Core>
#include <memory>

#include "absl/status/statusor.h"
#include "core/coupling/coupled_factor.h"
#include "core/mechanics/tissue_system.h"

namespace lipofill::mechanics {

/// The factor of the tissue's K + K_G alone, without inertia, damping and cells: for whoever solves
/// with right sides of their own.
///
/// It is made in float32. Where that is not enough - no positive pivots, or a solve that leaves
/// more than a thousandth of its right side - it is made in float64 from then on.
/// Checked by tests/unit/mechanics/tissue_factor_test.cc.
class TissueFactor {
 public:
  /// Analyses the pattern of `system`. A field violation of "model" when CHOLMOD cannot analyse it
  /// in memory.
  /// @param system  the tissue that is factored; outlives the factor, as does `cost`
  static absl::StatusOr<std::unique_ptr<TissueFactor>> create(const model::FaceModel& model, TissueSystem& system,
                                                              StepCost& cost);

  /// Factors at positions [m] (3, n_nodes) and springs (1: intact, 0: broken); forces and gaps of
  /// the system are then there too. False when the tissue is not positive definite there, in
  /// float64 either; the factor is then not usable.
  bool factor_at(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs);
  /// x = (K + K_G)^-1 r with the last factor [m].
  void solve(const Eigen::VectorXd& r, Eigen::VectorXd& x);
  /// X = (K + K_G)^-1 R for several right sides at once (n_dofs, n); each column as if alone.
  void solve_many(const Eigen::MatrixXd& r, Eigen::MatrixXd& x);
  /// Begins anew: what comes does not depend on what was.
  void begin(coupling::Precision precision = coupling::Precision::kSingle) { precision_ = precision; }
  bool is_double() const { return precision_ == coupling::Precision::kDouble; }

 private:
  TissueFactor(TissueSystem& system, std::shared_ptr<const coupling::FactorAnalysis> analysis, StepCost& cost)
      : system_(system), cost_(cost), factor_(std::move(analysis)), no_cells_(0, system.tissue().n_dofs()) {}
  bool factor_in(coupling::Precision precision);
  double measure_error();

  TissueSystem& system_;
  StepCost& cost_;
  coupling::CoupledFactor factor_;
  const Eigen::SparseMatrix<double> no_cells_;
  coupling::Precision precision_ = coupling::Precision::kSingle;
  Eigen::VectorXd load_, response_, left_;  ///< a new factor is tried with them
};

}  // namespace lipofill::mechanics
