#include "core/mechanics/tissue_factor.h"

#include <limits>
#include <string>
#include <utility>

#include "core/base/field_violations.h"
#include "core/model/shared_parts.h"

namespace lipofill::mechanics {
namespace {

using coupling::Precision;

/// Share of a load that a float32 solve may leave.
constexpr double kFactorTolerance = 1e-3;

}  // namespace

absl::StatusOr<std::unique_ptr<TissueFactor>> TissueFactor::create(const model::FaceModel& model, TissueSystem& system,
                                                                   StepCost& cost) {
  const Eigen::SparseMatrix<double>& s = system.tissue().system_matrix();
  const std::string key = model::key_of_analysis(system.setup().pattern_key, {}, false);
  auto analysis = model.shared->analyses.get(
      key, [&] { return coupling::FactorAnalysis::create(s, Eigen::SparseMatrix<double>(0, s.cols())); });
  if (!analysis.ok()) return field_violation("model", std::string(analysis.status().message()));
  return std::unique_ptr<TissueFactor>(new TissueFactor(system, *std::move(analysis), cost));
}

bool TissueFactor::factor_at(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs) {
  system_.assemble(x, springs, std::numeric_limits<double>::infinity());
  const PhaseTimer timer(cost_.times.factor);
  if (!is_double() && factor_in(Precision::kSingle) && measure_error() <= kFactorTolerance) return true;
  if (!is_double()) ++cost_.fallbacks;
  return factor_in(Precision::kDouble);
}

bool TissueFactor::factor_in(Precision precision) {
  precision_ = precision;
  ++cost_.factorisations;
  return factor_.factorise(system_.tissue().system_matrix(), no_cells_, precision);
}

void TissueFactor::solve(const Eigen::VectorXd& r, Eigen::VectorXd& x) {
  const PhaseTimer timer(cost_.times.solve);
  ++cost_.tissue_solves;
  factor_.solve(r, x);
}

void TissueFactor::solve_many(const Eigen::MatrixXd& r, Eigen::MatrixXd& x) {
  const PhaseTimer timer(cost_.times.solve);
  cost_.tissue_solves += static_cast<int>(r.cols());
  factor_.solve_many(r, x);
}

/// The share that a solve leaves of a pressure in every film.
double TissueFactor::measure_error() {
  load_ = system_.gaps().derivative().transpose() * Eigen::VectorXd::Ones(system_.gaps().volume().size());
  if (load_.isZero(0.0)) return 0.0;
  factor_.solve(load_, response_);
  left_ = -load_;
  left_.noalias() += system_.tissue().system_matrix().selfadjointView<Eigen::Lower>() * response_;
  return left_.norm() / load_.norm();
}

}  // namespace lipofill::mechanics
