#include "core/simulation/trial_shape.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/coupling/gap_volume.h"
#include "core/model/thicker_model.h"
#include "core/simulation/simulation_impl.h"

namespace lipofill::simulation {
namespace {

/// Fat that is added to a zone comes after the plan's own; how fast does not matter at rest [m3/s].
constexpr double kRateOfAdded = 1e-6;
/// The volume that a small motion sweeps is measured over this much of the largest displacement
/// [m].
constexpr double kSweep = 1e-6;
/// Members of an ensemble that are found side by side; between such groups somebody may cancel.
constexpr size_t kMembersTogether = 25;
/// A layer is thicker by this share where the difference to it is taken.
constexpr double kThickening = 1e-4;

absl::Status has_to_be_stepped(const std::string& why) {
  return absl::FailedPreconditionError(
      absl::StrCat("the settled shape of this plan cannot be found at once: ", why, "; run the plan to see its shape"));
}

void check_volumes(const TrialVolumes& volumes, size_t n_injections, FieldViolations& violations) {
  std::set<size_t> seen;
  for (size_t k = 0; k < volumes.injections.size(); ++k) {
    const size_t injection = volumes.injections[k].injection;
    const std::string field = absl::StrCat("injections[", k, "].index");
    if (injection >= n_injections) {
      violations.add(field, absl::StrCat("is ", injection, ", the plan has ", n_injections, " injections"));
    } else if (!seen.insert(injection).second) {
      violations.add(field, absl::StrCat("is ", injection, " again"));
    }
  }
  std::set<std::string> zones;
  for (size_t k = 0; k < volumes.added.size(); ++k) {
    if (zones.insert(volumes.added[k].zone).second) continue;
    violations.add(absl::StrCat("added[", k, "].zone"), absl::StrCat("is '", volumes.added[k].zone, "' again"));
  }
}

}  // namespace

bool has_zone(const PoolReport& pool, const std::string& zone) {
  const std::string all = " + " + pool.zones + " + ";
  return all.find(" + " + zone + " + ") != std::string::npos;
}

TrialShape::TrialShape(std::unique_ptr<Simulation> simulation)
    : simulation_(std::move(simulation)),
      rest_(std::make_unique<mechanics::SimulationState>(simulation_->impl_->state)) {}
TrialShape::~TrialShape() = default;

absl::StatusOr<std::unique_ptr<TrialShape>> TrialShape::create(std::shared_ptr<const model::FaceModel> model,
                                                               plan::SimulationSpec spec) {
  spec.goal = plan::TimeGoal::kSettledShape;
  auto simulation = Simulation::create(std::move(model), std::move(spec));
  if (!simulation.ok()) return simulation.status();
  Simulation::Impl& impl = *(*simulation)->impl_;
  // When a run of the plan would end does not matter to a shape at rest.
  impl.spec.settle_skin_speed = std::max(impl.spec.settle_skin_speed, std::numeric_limits<double>::min());
  impl.spec.end = std::numeric_limits<double>::infinity();
  const auto hindrance =
      DirectShape::find_hindrance(*impl.model, impl.films, impl.spec, {}, impl.state, *impl.stepper, false);
  if (hindrance) return has_to_be_stepped(hindrance->text());
  if (const absl::Status made = impl.make_direct(); !made.ok()) return made;
  return std::unique_ptr<TrialShape>(new TrialShape(*std::move(simulation)));
}

/// The plan's injections with other volumes, then what is added.
absl::StatusOr<plan::InjectionSchedule> TrialShape::schedule_with(const TrialVolumes& volumes) const {
  const Simulation::Impl& impl = *simulation_->impl_;
  FieldViolations violations;
  check_volumes(volumes, impl.spec.injections.size(), violations);
  if (!violations.empty()) return violations.to_status();
  std::vector<plan::InjectionSpec> injections = impl.spec.injections;
  std::vector<std::string> fields;
  for (size_t k = 0; k < injections.size(); ++k) fields.push_back(absl::StrCat("spec.injections[", k, "]"));
  for (size_t k = 0; k < volumes.injections.size(); ++k) {
    const TrialVolumes::Replaced& replaced = volumes.injections[k];
    injections[replaced.injection].volume = replaced.volume;
    fields[replaced.injection] = absl::StrCat("injections[", k, "]");
  }
  for (size_t k = 0; k < volumes.added.size(); ++k) {
    plan::InjectionSpec added;
    added.zone = volumes.added[k].zone;
    added.volume = volumes.added[k].volume;
    added.rate = kRateOfAdded;
    injections.push_back(added);
    fields.push_back(absl::StrCat("added[", k, "]"));
  }
  plan::InjectionSchedule schedule;
  for (size_t k = 0; k < injections.size(); ++k) {
    auto placed = schedule.place(*impl.model, impl.films, injections[k], 0.0);
    violations.absorb(fields[k], placed.status());
    if (placed.ok()) schedule.add(*std::move(placed));
  }
  if (!violations.empty()) return violations.to_status();
  return schedule;
}

absl::Status TrialShape::find(const TrialVolumes& volumes, bool from_last) {
  Simulation::Impl& impl = *simulation_->impl_;
  auto schedule = schedule_with(volumes);
  if (!schedule.ok()) return schedule.status();
  const auto hindrance =
      DirectShape::find_hindrance(*impl.model, impl.films, impl.spec, *schedule, *rest_, *impl.stepper, false);
  if (hindrance) return has_to_be_stepped(hindrance->text());
  impl.stepper->reset_cost();
  const double end = std::max(schedule->end(), impl.spec.step);
  std::vector<Eigen::VectorXd> injected;
  schedule->deliver_all(impl.films, 0.0, end, injected);
  mechanics::SimulationState next;
  const equilibrium::Settled settled =
      from_last ? impl.direct->follow(*rest_, injected, next) : impl.direct->find(*rest_, injected, next);
  if (settled.share == 0.0) return absl::FailedPreconditionError("no shape at rest was found: " + settled.reason);
  impl.schedule = *std::move(schedule);
  injected_ = std::move(injected);
  impl.state = *rest_;
  impl.become(settled, std::move(next), end);
  impl.report.way = "directly";
  impl.report.cost = impl.stepper->cost();
  share_ = settled.share;
  reason_ = settled.is_whole() ? "" : impl.reason;
  is_from_rest_ = impl.direct->equilibrium().is_from_rest();
  pools_.clear();
  for (Eigen::Index pool = 0; pool < settled.pool_head.size(); ++pool) {
    pools_.push_back({impl.direct->equilibrium().pools().names[static_cast<size_t>(pool)], settled.fat_volume[pool],
                      settled.pool_head[pool]});
  }
  return absl::OkStatus();
}

/// A tissue beside the plan's, one layer a little thicker, with what it stands on.
struct TrialShape::ThickerTissue {
  std::shared_ptr<const model::FaceModel> model;
  std::unique_ptr<step::CoupledStep> stepper;
  std::unique_ptr<DirectShape> direct;
  size_t layer = 0;
};

/// A layer that cannot be thicker has none.
void TrialShape::make_thicker_tissues() {
  if (!thicker_.empty()) return;
  const size_t n_layers = simulation_->impl_->model->layers.size();
  for (size_t k = 0; k < n_layers; ++k) {
    if (auto made = make_thicker_tissue(static_cast<int>(k))) thicker_.push_back(*std::move(made));
  }
}

std::vector<ShapeSensitivity> TrialShape::find_sensitivities() {
  std::vector<ShapeSensitivity> all;
  if (share_ < 1.0) return all;
  const Simulation::Impl& impl = *simulation_->impl_;
  const std::vector<model::TissueLayerSpec>& layers = impl.model->layers;
  make_thicker_tissues();
  std::vector<equilibrium::TissueBeside> beside;
  for (const ThickerTissue& tissue : thicker_) beside.push_back({&tissue.direct->equilibrium(), kThickening});
  const equilibrium::Sensitivities found = impl.direct->equilibrium().differentiate(beside);
  const auto add = [&](ShapeParameter parameter, const std::string& name,
                       const std::optional<equilibrium::Sensitivity>& sensitivity) {
    if (sensitivity) all.push_back(describe(parameter, name, *sensitivity));
  };
  for (size_t k = 0; k < pools_.size(); ++k) add(ShapeParameter::kPoolVolume, pools_[k].zones, found.by_volume[k]);
  for (size_t k = 0; k < layers.size(); ++k) add(ShapeParameter::kLayerModulus, layers[k].name, found.by_modulus[k]);
  for (size_t k = 0; k < beside.size(); ++k) {
    add(ShapeParameter::kLayerThickness, layers[thicker_[k].layer].name, found.by_tissue[k]);
  }
  return all;
}

/// Tells the share of an injection's volume that each pool receives; a zone in two pieces is two
/// pools.
Eigen::VectorXd TrialShape::pool_shares(size_t injection) const {
  const Simulation::Impl& impl = *simulation_->impl_;
  const auto placed = impl.schedule.place(*impl.model, impl.films, impl.spec.injections[injection], 0.0);
  const mechanics::FilmCells& cells = impl.stepper->cells();
  Eigen::VectorXd all = Eigen::VectorXd::Zero(cells.n());
  if (placed.ok()) {
    for (size_t k = 0; k < placed->cells.size(); ++k) {
      all[cells.offset[static_cast<size_t>(placed->film)] + placed->cells[k]] += placed->shares[k];
    }
  }
  Eigen::VectorXd on_tissue;
  cells.gather_tissue_part(all, on_tissue);
  return impl.direct->equilibrium().pools().sum(on_tissue);
}

std::vector<std::optional<ShapeSensitivity>> TrialShape::find_injection_sensitivities() {
  std::vector<std::optional<ShapeSensitivity>> all;
  if (share_ < 1.0) return all;
  const Simulation::Impl& impl = *simulation_->impl_;
  const auto by_pool = impl.direct->equilibrium().differentiate_by_volume();
  for (size_t k = 0; k < impl.spec.injections.size(); ++k) {
    const Eigen::VectorXd shares = pool_shares(k);
    std::optional<equilibrium::Sensitivity> sum;
    for (Eigen::Index pool = 0; pool < shares.size(); ++pool) {
      if (shares[pool] == 0.0) continue;
      const auto& found = by_pool[static_cast<size_t>(pool)];
      if (!found) {
        sum.reset();
        break;
      }
      if (!sum) {
        sum = equilibrium::Sensitivity{Eigen::Matrix3Xd::Zero(3, found->displacement.cols()),
                                       Eigen::VectorXd::Zero(found->pool_head.size())};
      }
      sum->displacement += shares[pool] * found->displacement;
      sum->pool_head += shares[pool] * found->pool_head;
    }
    all.emplace_back();
    if (sum) all.back() = describe(ShapeParameter::kPoolVolume, impl.spec.injections[k].zone, *sum);
  }
  return all;
}

absl::StatusOr<Eigen::MatrixXd> TrialShape::find_member_pressures(const std::vector<Eigen::VectorXd>& moduli,
                                                                  const Unwanted& unwanted) {
  Simulation::Impl& impl = *simulation_->impl_;
  auto [ensemble, volumes] = impl.direct->begin_ensemble(*rest_, injected_);
  const std::vector<ZoneReport> zones = simulation_->zone_reports();
  const Eigen::VectorXd& nominal = ensemble.nominal().pool_head;
  Eigen::MatrixXd pressures(static_cast<Eigen::Index>(zones.size()), static_cast<Eigen::Index>(moduli.size()));
  pressures.setConstant(std::numeric_limits<double>::infinity());
  for (size_t first = 0; first < moduli.size(); first += kMembersTogether) {
    if (const absl::Status wanted = check_wanted(unwanted); !wanted.ok()) return wanted;
    const size_t last = std::min(moduli.size(), first + kMembersTogether);
    std::vector<equilibrium::MemberChange> changes;
    for (size_t k = first; k < last; ++k) changes.push_back({moduli[k], volumes, nullptr});
    const auto members = ensemble.find(changes);
    for (size_t k = first; k < last; ++k) {
      const auto& member = members[k - first];
      if (!member.ok()) return member.status();
      if (!member->is_whole()) continue;
      for (size_t zone = 0; zone < zones.size(); ++zone) {
        double more = -std::numeric_limits<double>::infinity();
        for (size_t pool = 0; pool < pools_.size(); ++pool) {
          if (!has_zone(pools_[pool], zones[zone].name)) continue;
          const auto row = static_cast<Eigen::Index>(pool);
          more = std::max(more, member->pool_head[row] - nominal[row]);
        }
        pressures(static_cast<Eigen::Index>(zone), static_cast<Eigen::Index>(k)) = zones[zone].mean_pressure + more;
      }
    }
  }
  is_from_rest_ = true;
  return pressures;
}

Eigen::Matrix3Xd TrialShape::skin_displacement() const {
  return simulation_->impl_->skin_displacement();
}

std::optional<TrialShape::ThickerTissue> TrialShape::make_thicker_tissue(int layer) const {
  const Simulation::Impl& impl = *simulation_->impl_;
  ThickerTissue thicker;
  thicker.layer = static_cast<size_t>(layer);
  thicker.model = model::make_thicker(*impl.model, layer, kThickening);
  auto stepper = step::CoupledStep::create(*thicker.model, impl.films, impl.spec);
  if (!stepper.ok()) return {};
  thicker.stepper = *std::move(stepper);
  auto direct = DirectShape::create(*thicker.model, impl.films, impl.spec, *thicker.stepper, impl.state);
  if (!direct.ok()) return {};
  thicker.direct = *std::move(direct);
  return thicker;
}

/// A change of the shape as the skin shows it.
ShapeSensitivity TrialShape::describe(ShapeParameter parameter, const std::string& name,
                                      const equilibrium::Sensitivity& found) const {
  const Simulation::Impl& impl = *simulation_->impl_;
  const geometry::LayeredGrid& grid = impl.model->geometry.grid;
  const Eigen::Matrix3Xd skin = impl.skin_positions();
  ShapeSensitivity sensitivity{parameter, name, Eigen::Matrix3Xd(3, skin.cols()), 0.0, {}};
  for (Eigen::Index s = 0; s < skin.cols(); ++s) {
    sensitivity.skin.col(s) = found.displacement.col(impl.stepper->tissue()->skin_nodes[static_cast<size_t>(s)]);
  }
  const double largest = sensitivity.skin.colwise().norm().maxCoeff();
  if (largest > 0.0) {
    const double h = kSweep / largest;
    const double before = coupling::compute_swept_volume(grid, grid.nodes, skin);
    const double after = coupling::compute_swept_volume(grid, grid.nodes, skin + h * sensitivity.skin);
    sensitivity.skin_volume = (after - before) / h;
  }
  sensitivity.pool_pressure.assign(found.pool_head.begin(), found.pool_head.end());
  return sensitivity;
}

}  // namespace lipofill::simulation
