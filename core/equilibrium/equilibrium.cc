#include "core/equilibrium/equilibrium.h"

#include <algorithm>
#include <utility>

namespace lipofill::equilibrium {
namespace {

/// A part of the volume smaller than this is not tried any more: the path ends.
constexpr double kLeastPart = 1.0 / 64.0;

}  // namespace

absl::StatusOr<std::unique_ptr<Equilibrium>> Equilibrium::create(
    const model::FaceModel& model, const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
    mechanics::TissueSystem& system, mechanics::FilmGeometry& geometry, const StaticLoad& load,
    mechanics::StepCost& cost, const std::vector<Eigen::VectorXd>& entered) {
  auto factor = mechanics::TissueFactor::create(model, system, cost);
  if (!factor.ok()) return factor.status();
  return std::unique_ptr<Equilibrium>(
      new Equilibrium(model, *std::move(factor), films, cells, system, geometry, load, entered));
}

Settled Equilibrium::find(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance) {
  Solver solver(parts_.balance, parts_.response, parts_.pools);
  const Eigen::VectorXd rest = rest_volume();
  Shape good = Shape::at_rest(parts_.system.tissue().n_dofs(), parts_.pools);
  std::string reason;
  int n_factors_at_rest = 0;
  double share = 0.0;
  double part = 1.0;
  while (share < 1.0) {
    const double next = std::min(1.0, share + part);
    PoolTarget partial = target;
    if (next < 1.0) partial.volume = rest + next * (target.volume - rest);
    Shape shape = good;
    const bool can_leave = share > 0.0 || rest_start_.leave(partial.volume, springs, shape, n_factors_at_rest);
    if (can_leave && solver.solve(partial, springs, tolerance, shape)) {
      good = std::move(shape);
      share = next;
      part *= 2.0;
      continue;
    }
    reason = can_leave ? solver.reason() : "the tissue's stiffness is not positive definite at rest";
    part *= 0.5;
    if (part < kLeastPart) break;
  }
  parts_.balance.bring_to(good, springs);
  PoolTarget reached = target;
  if (share < 1.0) reached.volume = rest + share * (target.volume - rest);
  Settled settled = describe(reached, good, share);
  if (share < 1.0) settled.reason = reason;
  settled.cost = solver.cost();
  settled.cost.factors += n_factors_at_rest;
  remember(std::move(good), reached, springs, true);
  return settled;
}

Settled Equilibrium::follow(const PoolTarget& target, const Eigen::VectorXd& springs, double tolerance) {
  if (last_.shape.n_rows() == 0 || !mechanics::is_same(springs, last_.springs)) return find(target, springs, tolerance);
  Shape shape = last_.shape;
  const bool is_predicted = leave_last(target, shape);
  Solver solver(parts_.balance, parts_.response, parts_.pools, drag_mixing_);
  if (!solver.solve(target, springs, tolerance, shape)) return find(target, springs, tolerance);
  Settled settled = describe(target, shape, 1.0);
  settled.cost = solver.cost();
  if (is_predicted && shape.closed == last_.shape.closed) {
    trend_.learn(target.volume - last_.target.volume, shape.unknowns() - last_.shape.unknowns());
  }
  remember(std::move(shape), target, springs, false);
  return settled;
}

/// Moves the last shape by what the shapes before it tell of the volumes; by the held factor where
/// there were none. False, and the shape stays, where a pool is at the suction limit.
bool Equilibrium::leave_last(const PoolTarget& target, Shape& shape) {
  const bool is_limited = std::count(shape.is_at_limit.begin(), shape.is_at_limit.end(), 1) > 0;
  if (is_limited || !parts_.response.has_factor()) return false;
  if (!trend_.is_for(shape.unknowns().size())) {
    parts_.balance.bring_gaps_to(shape);
    Eigen::MatrixXd per_volume(shape.unknowns().size(), pools().n());
    Eigen::VectorXd dx, dp;
    for (int pool = 0; pool < pools().n(); ++pool) {
      const Eigen::VectorXd more = Eigen::VectorXd::Unit(shape.n_rows(), pool);
      if (!parts_.response.correct_volumes(parts_.balance, shape, more, dx, dp)) return false;
      per_volume.col(pool) << dx, dp;
    }
    trend_.begin(std::move(per_volume));
  }
  shape.move_by(trend_.predict(target.volume - last_.target.volume));
  return true;
}

void Equilibrium::remember(Shape shape, const PoolTarget& target, const Eigen::VectorXd& springs, bool is_from_rest) {
  last_ = {std::move(shape), target, springs};
  is_from_rest_ = is_from_rest;
  if (!is_from_rest) return;
  trend_.forget();
  drag_mixing_.reset();
}

Sensitivities Equilibrium::differentiate(const std::vector<TissueBeside>& beside) {
  factor_at(parts_, last_);
  refine(parts_, last_);
  std::vector<LoadChange> changes;
  std::vector<std::optional<Sensitivity>*> places;
  Sensitivities found;
  found.by_volume.resize(static_cast<size_t>(pools().n()));
  found.by_modulus.resize(static_cast<size_t>(parts_.system.n_layers()));
  found.by_tissue.resize(beside.size());
  const auto ask = [&](std::optional<LoadChange> change, std::optional<Sensitivity>& place) {
    if (!change) return;
    changes.push_back(*std::move(change));
    places.push_back(&place);
  };
  for (size_t k = 0; k < found.by_volume.size(); ++k) {
    ask(change_by_volume(last_, static_cast<int>(k)), found.by_volume[k]);
  }
  for (size_t k = 0; k < found.by_modulus.size(); ++k) {
    ask(change_by_modulus(parts_, last_, static_cast<int>(k)), found.by_modulus[k]);
  }
  for (size_t k = 0; k < beside.size(); ++k) {
    ask(change_towards(parts_, last_, beside[k].tissue->parts_, beside[k].step), found.by_tissue[k]);
  }
  auto answers = answer(changes);
  for (size_t k = 0; k < answers.size(); ++k) *places[k] = std::move(answers[k]);
  return found;
}

std::vector<std::optional<Sensitivity>> Equilibrium::differentiate_by_volume() {
  refine(parts_, last_);
  std::vector<LoadChange> changes;
  for (int pool = 0; pool < pools().n(); ++pool) changes.push_back(change_by_volume(last_, pool));
  return answer(changes);
}

std::vector<std::optional<Sensitivity>> Equilibrium::answer(const std::vector<LoadChange>& changes) {
  std::vector<std::optional<Sensitivity>> all;
  for (const auto& tangent :
       find_tangents(parts_.balance, parts_.response, pools(), last_.shape, last_.springs, changes)) {
    std::optional<Sensitivity>& found = all.emplace_back();
    if (!tangent) continue;
    found = Sensitivity{Eigen::Matrix3Xd::Zero(3, parts_.system.rest_positions().cols()),
                        tangent->pressure.head(pools().n())};
    parts_.system.add_displacement(tangent->displacement, found->displacement);
  }
  return all;
}

Settled Equilibrium::describe(const PoolTarget& target, const Shape& shape, double share) const {
  Settled settled;
  settled.share = share;
  settled.positions = parts_.balance.positions();
  settled.cell_volume = parts_.balance.gap().cwiseMax(0.0);
  settled.cell_pressure = parts_.balance.cell_pressure();
  settled.pool_volume = pools().sum(settled.cell_volume);
  settled.pool_head = shape.pressure.head(pools().n());
  settled.is_at_limit = shape.is_at_limit;
  for (int cell = 0; cell < pools().n_cells(); ++cell) {
    // Exactly the limit, by which the void is known.
    const auto pool = static_cast<size_t>(pools().of_cell[cell]);
    if (shape.is_at_limit[pool])
      settled.cell_pressure[cell] = std::min(settled.cell_pressure[cell], target.lowest_head);
  }
  settled.fat_volume = target.volume;
  settled.closed = shape.closed;
  settled.force_error = parts_.balance.relative_force();
  settled.is_double = parts_.factor->is_double();
  return settled;
}

}  // namespace lipofill::equilibrium
