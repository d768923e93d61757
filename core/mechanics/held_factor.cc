#include "core/mechanics/held_factor.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/model/shared_parts.h"

namespace lipofill::mechanics {
namespace {

constexpr double kGibibyte = 1024.0 * 1024.0 * 1024.0;
/// A session that needs more would crowd out the others.
constexpr double kMaxFactorBytes = 4.0 * kGibibyte;
/// Films on tissue of more cells have no dense compliance: it would take longer than the solves
/// that it saves, and more memory than the factor.
constexpr int kMaxDenseCells = 16384;
/// Iterations with a factor of earlier positions, beyond those that a new one would need, that cost
/// as much as it does.
constexpr int kLateIterationsOfAFactor = 6;
/// Share of a load that a float32 solve may leave: well below what an iteration with a factor of
/// its own positions may.
constexpr double kFactorTolerance = 1e-3;

}  // namespace

absl::StatusOr<std::unique_ptr<HeldFactor>> HeldFactor::create(const model::FaceModel& model, TissueSystem& system,
                                                               StepCost& cost) {
  const Eigen::SparseMatrix<double>& s = system.tissue().system_matrix();
  const Eigen::SparseMatrix<double>& b = system.gaps().derivative();
  const bool is_dense = b.rows() <= kMaxDenseCells;
  const std::string key = model::key_of_analysis(system.setup().pattern_key, system.gap_keys(), is_dense);
  auto analysis = model.shared->analyses.get(key, [&] {
    return coupling::FactorAnalysis::create(s, is_dense ? b : Eigen::SparseMatrix<double>(0, b.cols()));
  });
  if (!analysis.ok()) return field_violation("model", std::string(analysis.status().message()));
  const double bytes = static_cast<double>((*analysis)->n_values()) * sizeof(float);
  if (bytes > kMaxFactorBytes) {
    return field_violation(
        "model", absl::StrCat("needs ", bytes / kGibibyte, " GiB to factor with these films, must be at most ",
                              kMaxFactorBytes / kGibibyte, " GiB: take fewer hexahedra"));
  }
  return std::unique_ptr<HeldFactor>(new HeldFactor(system, *std::move(analysis), cost));
}

bool HeldFactor::factor_at(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs, double dt,
                           coupling::Precision precision) {
  system_.assemble(x, springs, dt);
  const PhaseTimer timer(cost_.times.factor);
  positions_ = x;
  springs_ = springs;
  dt_ = 0.0;
  ++cost_.factorisations;
  if (!factor_.factorise(system_.tissue().system_matrix(), system_.gaps().derivative(), precision)) return false;
  const bool is_exact = precision == coupling::Precision::kDouble || measure_error() <= kFactorTolerance;
  if (!is_exact) return false;
  dt_ = dt;
  precision_ = precision;
  return true;
}

bool HeldFactor::is_due(const SimulationState& state) {
  return state.factored_dt == 0.0 || state.late_iterations >= kLateIterationsOfAFactor;
}

bool HeldFactor::renew(double dt, SimulationState& state) {
  bool is_factored = false;
  if (state.factored_in_double == 0) {
    is_factored = factor_at(state.positions, state.spring_is_intact, dt, coupling::Precision::kSingle);
  }
  if (!is_factored) {
    if (state.factored_in_double == 0) ++cost_.fallbacks;
    state.factored_in_double = 1;
    is_factored = factor_at(state.positions, state.spring_is_intact, dt, coupling::Precision::kDouble);
  }
  if (!is_factored) return false;
  state.factored_positions = positions_;
  state.factored_springs = springs_;
  state.factored_dt = dt;
  state.late_iterations = 0;
  return true;
}

HeldFactor::TakenUp HeldFactor::take_up(const SimulationState& state) {
  const auto precision = state.factored_in_double == 0 ? coupling::Precision::kSingle : coupling::Precision::kDouble;
  const bool is_at_hand = state.factored_dt == dt_ && precision == precision_ &&
                          is_same(state.factored_springs, springs_) && is_same(state.factored_positions, positions_);
  if (is_at_hand) return TakenUp::kAtHand;
  const bool is_made = factor_at(state.factored_positions, state.factored_springs, state.factored_dt, precision);
  return is_made ? TakenUp::kMade : TakenUp::kImpossible;
}

/// The share that a solve leaves of a load which bends and shears all there is: pressure in every
/// film, and weight.
double HeldFactor::measure_error() {
  const solid::Tissue& tissue = system_.tissue();
  Trial& t = trial_;
  t.pressure.setOnes(system_.gaps().volume().size());
  t.load.noalias() = system_.gaps().derivative().transpose() * t.pressure;
  t.weight.setZero(t.load.size());
  for (size_t k = 0; k < tissue.dof_of_component().size(); ++k) {
    if (tissue.dof_of_component()[k] >= 0) t.weight[tissue.dof_of_component()[k]] = tissue.mass()[k / 3];
  }
  const double pressure_size = t.load.norm();
  if (t.weight.norm() > 0.0) t.load += (pressure_size > 0.0 ? pressure_size : 1.0) / t.weight.norm() * t.weight;
  factor_.solve_gap_response(t.load, t.response);
  t.pressure.setZero();
  factor_.solve_displacement(t.pressure, t.displacement);
  t.left = -t.load;
  t.left.noalias() += tissue.system_matrix().selfadjointView<Eigen::Lower>() * t.displacement;
  return t.left.norm() / t.load.norm();
}

}  // namespace lipofill::mechanics
