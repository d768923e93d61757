#include "core/simulation/direct_shape.h"

#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/units.h"

namespace lipofill::simulation {
namespace {

using equilibrium::Hindrance;
using mechanics::FilmState;
using mechanics::SimulationState;

/// Forces are left to this share: some 5e-4 mm of the skin (core/doc/decisions/028-equilibrium.md).
constexpr double kForceTolerance = 1e-3;

/// The volume that each cell on tissue would hold if no fat flowed [m3].
Eigen::VectorXd volume_with(const mechanics::FilmCells& cells, const SimulationState& rest,
                            const std::vector<Eigen::VectorXd>& injected) {
  Eigen::VectorXd all, on_tissue;
  cells.gather(rest, &FilmState::volume, all);
  for (size_t f = 0; f < injected.size(); ++f) all.segment(cells.offset[f], cells.n_of(f)) += injected[f];
  cells.gather_tissue_part(all, on_tissue);
  return on_tissue;
}

/// A pool that more is taken out of than it holds: what is owed depends on when.
std::optional<Hindrance> find_overdraft(const std::vector<plan::FilmLayout>& films, const mechanics::FilmCells& cells,
                                        plan::InjectionSchedule schedule, const SimulationState& rest) {
  std::vector<Eigen::VectorXd> injected;
  schedule.deliver_all(films, 0.0, schedule.end(), injected);
  const equilibrium::Pools pools = equilibrium::find_pools(films, cells);
  const Eigen::VectorXd volume = pools.sum(volume_with(cells, rest, injected));
  for (int pool = 0; pool < pools.n(); ++pool) {
    if (volume[pool] > 0.0) continue;
    return Hindrance{"injections", absl::StrCat("take ", -volume[pool] / kCubicMetresPerMillilitre, " mL more out of ",
                                                pools.names[static_cast<size_t>(pool)], " than it holds")};
  }
  return {};
}

}  // namespace

std::optional<Hindrance> DirectShape::find_hindrance(const model::FaceModel& model,
                                                     const std::vector<plan::FilmLayout>& films,
                                                     const plan::SimulationSpec& spec,
                                                     const plan::InjectionSchedule& schedule,
                                                     const SimulationState& rest, const step::CoupledStep& stepper,
                                                     bool is_injected) {
  const mechanics::TissueSetup* tissue = stepper.tissue();
  auto found = equilibrium::find_hindrance(
      spec, model, films, tissue != nullptr ? tissue->ligaments : std::vector<mechanics::LigamentLayout>(),
      schedule.end(), is_injected);
  if (is_injected) return found;
  return found.has_value() ? found : find_overdraft(films, stepper.cells(), schedule, rest);
}

absl::StatusOr<std::unique_ptr<DirectShape>> DirectShape::create(const model::FaceModel& model,
                                                                 const std::vector<plan::FilmLayout>& films,
                                                                 const plan::SimulationSpec& spec,
                                                                 step::CoupledStep& stepper,
                                                                 const SimulationState& from) {
  std::vector<Eigen::VectorXd> entered;
  for (const FilmState& film : from.films) entered.push_back(film.is_entered);
  auto equilibrium =
      equilibrium::Equilibrium::create(model, films, stepper.cells(), *stepper.system(), stepper.geometry(),
                                       {spec.gravity, spec.fat_density}, stepper.cost(), entered);
  if (!equilibrium.ok()) return equilibrium.status();
  const double limit = spec.suction_limit.value_or(std::numeric_limits<double>::infinity());
  return std::unique_ptr<DirectShape>(new DirectShape(stepper.cells(), *std::move(equilibrium), -limit));
}

equilibrium::Settled DirectShape::find(const SimulationState& from, const std::vector<Eigen::VectorXd>& injected,
                                       SimulationState& next) {
  equilibrium::Settled settled =
      equilibrium_->find(target_with(from, injected), from.spring_is_intact, kForceTolerance);
  fill(from, settled, next);
  return settled;
}

equilibrium::Settled DirectShape::follow(const SimulationState& from, const std::vector<Eigen::VectorXd>& injected,
                                         SimulationState& next) {
  equilibrium::Settled settled =
      equilibrium_->follow(target_with(from, injected), from.spring_is_intact, kForceTolerance);
  fill(from, settled, next);
  return settled;
}

std::optional<std::string> DirectShape::find_breaking_ligament(
    const std::vector<mechanics::LigamentLayout>& ligaments) const {
  const solid::Tissue& tissue = equilibrium_->parts().system.tissue();
  for (const mechanics::LigamentLayout& ligament : ligaments) {
    for (int k = 0; k < ligament.n_springs; ++k) {
      if (tissue.spring_tension(ligament.first_spring + k) > ligament.breaking_force) return ligament.name;
    }
  }
  return {};
}

DirectShape::Members DirectShape::begin_ensemble(const SimulationState& from,
                                                 const std::vector<Eigen::VectorXd>& injected) {
  const equilibrium::PoolTarget target = target_with(from, injected);
  return {{*equilibrium_, target, from.spring_is_intact, kForceTolerance}, target.volume};
}

equilibrium::Ensemble DirectShape::begin_ensemble(const SimulationState& from, const Eigen::VectorXd& pool_volumes) {
  return {*equilibrium_, {pool_volumes, lowest_head_}, from.spring_is_intact, kForceTolerance};
}

Eigen::VectorXd DirectShape::pool_volumes(const SimulationState& from) const {
  return equilibrium_->pools().sum(volume_with(cells_, from, {}));
}

equilibrium::PoolTarget DirectShape::target_with(const SimulationState& from,
                                                 const std::vector<Eigen::VectorXd>& injected) const {
  return {equilibrium_->pools().sum(volume_with(cells_, from, injected)), lowest_head_};
}

void DirectShape::fill(const SimulationState& from, const equilibrium::Settled& settled, SimulationState& next) const {
  next = from;
  next.positions = settled.positions;
  next.velocities.setZero();
  fill_films(settled, next);
}

/// Fat at rest fills its gap; at the suction limit each cell has its share of it, the rest is void.
void DirectShape::fill_films(const equilibrium::Settled& settled, SimulationState& next) const {
  const equilibrium::Pools& pools = equilibrium_->pools();
  for (size_t k = 0; k < cells_.on_tissue.size(); ++k) {
    const int f = cells_.film_of(cells_.on_tissue[k]);
    const int cell = cells_.on_tissue[k] - cells_.offset[f];
    const auto row = static_cast<Eigen::Index>(k);
    const int pool = pools.of_cell[k];
    const bool is_full = settled.is_at_limit[static_cast<size_t>(pool)] == 0;
    const double filled = is_full ? 1.0 : settled.fat_volume[pool] / settled.pool_volume[pool];
    next.films[f].volume[cell] = filled * settled.cell_volume[row];
    next.films[f].pressure[cell] = settled.cell_pressure[row];
  }
}

}  // namespace lipofill::simulation
