#include "tests/bench/equilibrium_bench.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/model/thicker_model.h"

namespace lipofill::bench {
namespace {

constexpr double kTolerance = 1e-3;
constexpr double kExact = 1e-9;
/// A drag moves a slider by so much at a time [m3].
constexpr double kDragStep = 0.1e-6;
constexpr int kDragSteps = 20;
constexpr int kMembers = 32;
/// Share of its thickness that a layer is thicker by, for a difference.
constexpr double kThickening = 0.01;
/// Moduli of members lie within this factor of the nominal ones.
constexpr double kLargestModulus = 1.25;

}  // namespace

absl::StatusOr<std::unique_ptr<EquilibriumBench>> EquilibriumBench::create(const JawAngle& jaw) {
  std::unique_ptr<EquilibriumBench> bench(new EquilibriumBench());
  if (const absl::Status status = bench->set_up(jaw); !status.ok()) return status;
  return bench;
}

absl::Status EquilibriumBench::set_up(const JawAngle& jaw) {
  scale_ = jaw.scale;
  model_ = jaw.model;
  spec_ = jaw.settled_shape;
  if (auto placed = plan::place_plan(*jaw.model, jaw.settled_shape, nullptr, placed_); !placed.ok()) return placed;
  auto stepper = step::CoupledStep::create(*jaw.model, placed_.films, jaw.settled_shape);
  if (!stepper.ok()) return stepper.status();
  stepper_ = *std::move(stepper);
  auto factor = mechanics::TissueFactor::create(*jaw.model, *stepper_->system(), stepper_->cost());
  if (!factor.ok()) return factor.status();
  factor_ = *std::move(factor);
  auto made = make_equilibrium(*jaw.model, *stepper_, jaw);
  if (!made.ok()) return made.status();
  equilibrium_ = *std::move(made);
  for (int layer = 0; layer < stepper_->system()->n_layers(); ++layer) {
    if (const absl::Status added = add_thicker(layer, jaw); !added.ok()) return added;
  }
  const mechanics::SimulationState rest = stepper_->rest_state();
  springs_ = rest.spring_is_intact;
  std::vector<Eigen::VectorXd> injected;
  placed_.schedule.deliver_all(placed_.films, 0.0, placed_.schedule.end(), injected);
  Eigen::VectorXd all(stepper_->cells().n()), on_tissue;
  for (size_t f = 0; f < injected.size(); ++f) {
    all.segment(stepper_->cells().offset[f], injected[f].size()) = injected[f];
  }
  stepper_->cells().gather_tissue_part(all, on_tissue);
  target_.volume = equilibrium_->rest_volume() + equilibrium_->pools().sum(on_tissue);
  exact_ = equilibrium_->find(target_, springs_, kExact);
  return exact_.is_whole() ? absl::OkStatus() : absl::InternalError("no equilibrium: " + exact_.reason);
}

absl::StatusOr<std::unique_ptr<equilibrium::Equilibrium>> EquilibriumBench::make_equilibrium(
    const model::FaceModel& model, step::CoupledStep& stepper, const JawAngle& jaw) const {
  return equilibrium::Equilibrium::create(model, placed_.films, stepper.cells(), *stepper.system(), stepper.geometry(),
                                          {jaw.settled_shape.gravity, jaw.settled_shape.fat_density}, stepper.cost());
}

absl::Status EquilibriumBench::add_thicker(int layer, const JawAngle& jaw) {
  Thicker& thicker = beside_.emplace_back();
  thicker.model = model::make_thicker(*model_, layer, kThickening);
  auto stepper = step::CoupledStep::create(*thicker.model, placed_.films, spec_);
  if (!stepper.ok()) return stepper.status();
  thicker.stepper = *std::move(stepper);
  auto made = make_equilibrium(*thicker.model, *thicker.stepper, jaw);
  if (!made.ok()) return made.status();
  thicker.equilibrium = *std::move(made);
  return absl::OkStatus();
}

absl::Status EquilibriumBench::run_round() {
  if (const absl::Status measured = measure_unit(); !measured.ok()) return measured;
  measure_cold();
  measure_drag();
  measure_sensitivities();
  if (const absl::Status built = measure_thicker_tissue(); !built.ok()) return built;
  return measure_members();
}

/// At the settled shape; where the system has to compute anew, as it is in an iteration.
absl::Status EquilibriumBench::measure_unit() {
  Eigen::VectorXd answer;
  const Eigen::VectorXd load = Eigen::VectorXd::Ones(stepper_->system()->tissue().n_dofs());
  factor_->begin();
  Stopwatch watch;
  const bool factored = factor_->factor_at(exact_.positions, springs_);
  factor_->solve(load, answer);
  unit_.add(watch.lap());
  return factored ? absl::OkStatus() : absl::InternalError("the tissue is not positive definite");
}

void EquilibriumBench::measure_cold() {
  Stopwatch watch;
  const equilibrium::Settled found = equilibrium_->find(target_, springs_, kTolerance);
  cold_.add(watch.lap());
  cold_cost_ = found.cost;
  double largest = 0.0;
  for (const int node : stepper_->tissue()->skin_nodes) {
    largest = std::max(largest, (found.positions.col(node) - exact_.positions.col(node)).norm());
  }
  error_mm_ = std::max(error_mm_, 1e3 * largest);
}

/// To and fro about the plan's volume in the first pool.
void EquilibriumBench::measure_drag() {
  equilibrium::PoolTarget dragged = target_;
  equilibrium_->follow(dragged, springs_, kTolerance);
  for (int k = 0; k < kDragSteps; ++k) {
    dragged.volume[0] += k % 10 < 5 ? -kDragStep : kDragStep;
    Stopwatch watch;
    const equilibrium::Settled found = equilibrium_->follow(dragged, springs_, kTolerance);
    drag_.add(watch.lap());
    drag_iterations_ += found.cost.iterations;
    drag_factors_ += found.cost.factors;
  }
}

/// By the volume of each pool and by the stiffness and the thickness of each layer.
void EquilibriumBench::measure_sensitivities() {
  equilibrium_->find(target_, springs_, kTolerance);
  std::vector<equilibrium::TissueBeside> beside;
  for (const Thicker& thicker : beside_) beside.push_back({thicker.equilibrium.get(), kThickening});
  Stopwatch watch;
  const equilibrium::Sensitivities found = equilibrium_->differentiate(beside);
  sensitivity_.add(watch.lap());
  n_sensitivities_ = 0;
  for (const auto* some : {&found.by_volume, &found.by_modulus, &found.by_tissue}) {
    n_sensitivities_ +=
        static_cast<int>(std::count_if(some->begin(), some->end(), [](const auto& one) { return one; }));
  }
}

/// Building what a member with another thickness stands on.
absl::Status EquilibriumBench::measure_thicker_tissue() {
  Stopwatch watch;
  const auto model = model::make_thicker(*model_, 0, 0.05);
  const auto stepper = step::CoupledStep::create(*model, placed_.films, spec_);
  if (!stepper.ok()) return stepper.status();
  thicker_.add(watch.lap());
  return absl::OkStatus();
}

/// Alone, and the same again side by side.
absl::Status EquilibriumBench::measure_members() {
  equilibrium::Ensemble ensemble(*equilibrium_, target_, springs_, kTolerance);
  const int n_layers = stepper_->system()->n_layers();
  std::vector<equilibrium::MemberChange> changes;
  for (int k = 0; k < kMembers; ++k) {
    equilibrium::MemberChange& change = changes.emplace_back();
    change.volumes = target_.volume;
    change.moduli.resize(n_layers);
    for (int layer = 0; layer < n_layers; ++layer) {
      change.moduli[layer] = std::pow(kLargestModulus, std::sin(1.0 + 3.0 * k + 5.0 * layer));
    }
  }
  for (const equilibrium::MemberChange& change : changes) {
    Stopwatch watch;
    const auto alone = ensemble.find({change});
    member_.add(watch.lap());
    if (const absl::Status status = check_members(alone); !status.ok()) return status;
  }
  Stopwatch watch;
  const auto together = ensemble.find(changes);
  batch_.add((1.0 / kMembers) * watch.lap());
  return check_members(together);
}

absl::Status EquilibriumBench::check_members(const std::vector<absl::StatusOr<equilibrium::Settled>>& members) {
  for (const auto& member : members) {
    if (!member.ok()) return member.status();
    if (!member->is_whole()) return absl::InternalError("a member has no shape: " + member->reason);
    member_factors_ += member->cost.factors;
    member_iterations_ += member->cost.iterations;
  }
  return absl::OkStatus();
}

nlohmann::ordered_json EquilibriumBench::to_json() const {
  const double unit = unit_.median_cpu_ms();
  return {{"scale", scale_},
          {"unit_ms", unit},
          {"cold_f", cold_.median_cpu_ms() / unit},
          {"cold_factors", cold_cost_.factors},
          {"cold_iterations", cold_cost_.iterations},
          {"drag_f", drag_.median_cpu_ms() / unit},
          {"drag_updates_per_s", 1e3 / drag_.mean_cpu_ms()},
          {"drag_iterations", static_cast<double>(drag_iterations_) / static_cast<double>(drag_.size())},
          {"drag_factors", drag_factors_},
          {"sensitivity_f", sensitivity_.median_cpu_ms() / unit / std::max(1, n_sensitivities_)},
          {"sensitivities", n_sensitivities_},
          {"thicker_tissue_f", thicker_.median_cpu_ms() / unit},
          {"ensemble_member_f", member_.median_cpu_ms() / unit},
          {"ensemble_batch_f", batch_.median_cpu_ms() / unit},
          {"ensemble_factors", member_factors_},
          {"ensemble_iterations", 0.5 * member_iterations_ / static_cast<double>(member_.size())},
          {"error_mm", error_mm_}};
}

}  // namespace lipofill::bench
