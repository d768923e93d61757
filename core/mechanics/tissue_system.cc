#include "core/mechanics/tissue_system.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/model/shared_parts.h"

namespace lipofill::mechanics {
namespace {

/// A balance of forces smaller than this share of stiffness times extent is round-off.
constexpr double kLeastForceShare = 1e-10;

double find_least_force(const solid::Tissue& tissue) {
  const Eigen::Matrix3Xd& rest = tissue.mesh().rest_positions;
  const double extent = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
  return kLeastForceShare * tissue.system_matrix().diagonal().norm() * extent;
}

}  // namespace

absl::StatusOr<std::unique_ptr<TissueSystem>> TissueSystem::create(const model::FaceModel& model,
                                                                   const std::vector<plan::FilmLayout>& films,
                                                                   const FilmCells& cells,
                                                                   const plan::SimulationSpec& spec, StepCost& cost) {
  auto setup = set_up_tissue(model, films, spec);
  if (!setup.ok()) return setup.status();
  std::unique_ptr<TissueSystem> system(new TissueSystem(*std::move(setup), cost));
  if (const absl::Status status = system->set_up_gaps(model, films); !status.ok()) return status;
  if (system->tissue().n_dofs() == 0)
    return field_violation("model", "holds every node of its tissue: nothing can move");
  system->least_force_ = find_least_force(system->tissue());
  if (const absl::Status status = system->check_every_cell_can_open(films, cells); !status.ok()) return status;
  return system;
}

absl::Status TissueSystem::set_up_gaps(const model::FaceModel& model, const std::vector<plan::FilmLayout>& films) {
  const solid::Tissue& tissue = setup_.tissue;
  const geometry::LayeredGrid& grid = model.geometry.grid;
  std::vector<coupling::GapVolume> gaps;
  for (const plan::FilmLayout& film : films) {
    if (film.wall != plan::FilmWallKind::kTissue) continue;
    const coupling::WallNodes& walls = setup_.walls[gaps.size()];
    gap_keys_.push_back(model::key_of_gap(setup_.pattern_key, grid, walls, film.grid, film.pieces));
    auto gap =
        model.shared->gaps.get(gap_keys_.back(), [&]() -> absl::StatusOr<std::shared_ptr<const coupling::GapGeometry>> {
          return std::make_shared<const coupling::GapGeometry>(coupling::make_gap_geometry(
              grid, walls, film.grid, film.pieces, tissue.dof_of_component(), tissue.n_dofs()));
        });
    if (!gap.ok()) return gap.status();
    gaps.emplace_back(*std::move(gap));
  }
  gaps_ = std::make_unique<coupling::GapSystem>(std::move(gaps), tissue.n_dofs());
  return absl::OkStatus();
}

absl::Status TissueSystem::check_every_cell_can_open(const std::vector<plan::FilmLayout>& films,
                                                     const FilmCells& cells) {
  evaluate_gaps(rest_positions());
  Eigen::VectorXd opening = Eigen::VectorXd::Zero(gaps_->volume().size());
  const Eigen::SparseMatrix<double>& b = gaps_->derivative();
  for (int column = 0; column < b.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(b, column); it; ++it) opening[it.row()] += std::abs(it.value());
  }
  for (size_t row = 0; row < cells.on_tissue.size(); ++row) {
    if (opening[static_cast<Eigen::Index>(row)] > 0.0) continue;
    const int f = cells.film_of(cells.on_tissue[row]);
    const int cell = cells.on_tissue[row] - cells.offset[f];
    const geometry::ChartPoint at = films[f].cell_centre(cell);
    return field_violation(
        absl::StrCat("films[", f, "].zones[", films[f].grid.zone_of_cell[cell], "]"),
        absl::StrCat("has a film cell at (", at.xi, ", ", at.eta,
                     ") of the chart where no node of the tissue is free: make the zone at least two cells wide"));
  }
  return absl::OkStatus();
}

void TissueSystem::set_rest(SimulationState& state) const {
  state.positions = rest_positions();
  state.velocities.setZero(3, state.positions.cols());
  for (Eigen::Matrix3Xd& earlier : state.earlier_velocities) earlier = state.velocities;
  state.spring_is_intact.setOnes(n_ligament_springs());
  state.factored_positions = state.positions;
  state.factored_springs = state.spring_is_intact;
}

int TissueSystem::n_ligament_springs() const {
  if (setup_.ligaments.empty()) return 0;
  return setup_.ligaments.back().first_spring + setup_.ligaments.back().n_springs;
}

void TissueSystem::bring_forces_to(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs, double dt) {
  if (is_same(springs, forces_springs_) && is_same(x, forces_positions_)) return;
  const PhaseTimer timer(cost_.times.element);
  set_springs(x, springs);
  const bool damping_needs_stiffness = tissue().damping().beta > 0.0;
  if (damping_needs_stiffness) {
    setup_.tissue.assemble(x, dt);
  } else {
    setup_.tissue.compute_force(x);
  }
}

void TissueSystem::assemble(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs, double dt) {
  {
    const PhaseTimer timer(cost_.times.element);
    set_springs(x, springs);
    setup_.tissue.assemble(x, dt);
  }
  const PhaseTimer timer(cost_.times.coupling);
  evaluate_gaps(x);
}

absl::Status TissueSystem::scale_moduli(const Eigen::VectorXd& factors) {
  std::vector<double> moduli = setup_.youngs_moduli;
  for (size_t k = 0; k < moduli.size(); ++k) moduli[k] *= factors[static_cast<Eigen::Index>(k)];
  const absl::Status set = setup_.tissue.set_youngs_moduli(moduli);
  if (!set.ok()) return set;
  forces_positions_.resize(3, 0);
  moduli_ = factors;
  return set;
}

void TissueSystem::set_springs(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& springs) {
  for (int k = 0; k < springs.size(); ++k) setup_.tissue.set_spring_intact(k, springs[k] > 0.0);
  forces_positions_ = x;
  forces_springs_ = springs;
}

void TissueSystem::add_displacement(const Eigen::VectorXd& dx, Eigen::Matrix3Xd& x) const {
  const std::vector<int>& dofs = tissue().dof_of_component();
  for (size_t k = 0; k < dofs.size(); ++k) {
    if (dofs[k] >= 0) x.data()[k] += dx[dofs[k]];
  }
}

}  // namespace lipofill::mechanics
