#include "core/step/coupled_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/field_violations.h"
#include "core/model/shared_parts.h"

namespace lipofill::step {
namespace {

constexpr double kGibibyte = 1024.0 * 1024.0 * 1024.0;
/// A session that needs more would crowd out the others.
constexpr double kMaxFactorBytes = 4.0 * kGibibyte;
/// Of the factor with what making it takes, of matrices with their scatter maps, and of the vectors of steps, states
/// and frames. Measured: 22 MB a simulation of jaw_angle, reckoned 24; 150 MB at four times its size, reckoned 124.
constexpr uint64_t kBytesAFactorValue = 8;
constexpr uint64_t kBytesAValue = 24;
constexpr uint64_t kBytesADof = 600;
constexpr uint64_t kBytesACell = 4000;

/// Films on tissue of more cells have no dense compliance: it would take longer than the solves that it saves, and more
/// memory than the factor.
constexpr int kMaxDenseCells = 16384;
/// Of stiffness times extent: a balance of forces this small is round-off.
constexpr double kLeastForceShare = 1e-10;

film::Fat make_fat(const plan::SimulationSpec& spec) {
  film::Fat fat;
  fat.viscosity = spec.fat_viscosity;
  fat.density = spec.fat_density;
  fat.flow_index = spec.fat_flow_index;
  fat.yield_stress = spec.fat_yield_stress;
  if (spec.fat_shear_modulus.has_value()) fat.shear_modulus = *spec.fat_shear_modulus;
  return fat;
}

}  // namespace

CoupledStep::CoupledStep(const model::FaceModel& model, const std::vector<plan::FilmLayout>& films,
                         const plan::SimulationSpec& spec)
    : model_(model),
      films_(films),
      coupling_(spec.coupling),
      gravity_(spec.gravity),
      fat_(make_fat(spec)),
      suction_limit_(spec.suction_limit.value_or(std::numeric_limits<double>::infinity())) {}

absl::StatusOr<std::unique_ptr<CoupledStep>> CoupledStep::create(const model::FaceModel& model,
                                                                 const std::vector<plan::FilmLayout>& films,
                                                                 const plan::SimulationSpec& spec) {
  std::unique_ptr<CoupledStep> step(new CoupledStep(model, films, spec));
  if (!model.layers.empty()) {
    auto tissue = mechanics::set_up_tissue(model, films, spec);
    if (!tissue.ok()) return tissue.status();
    step->tissue_ = std::make_unique<mechanics::TissueSetup>(*std::move(tissue));
  }
  const absl::Status status = step->set_up();
  if (!status.ok()) return status;
  return step;
}

absl::Status CoupledStep::set_up() {
  std::vector<coupling::GapVolume> gaps;
  std::vector<std::string> gap_keys;
  cell_offset_ = {0};
  for (const plan::FilmLayout& film : films_) {
    const int offset = cell_offset_.back();
    cell_offset_.push_back(offset + film.grid.n_cells());
    gap_of_film_.push_back(-1);
    projections_.push_back(std::make_unique<film::FilmProjection>(film.grid));
    viscosity_.emplace_back(film.grid);
    advection_.emplace_back(film.grid);
    if (film.wall != plan::FilmWallKind::kTissue) continue;
    gap_of_film_.back() = static_cast<int>(gaps.size());
    gap_keys.push_back(model::key_of_gap(tissue_->key, model_.geometry.grid, tissue_->walls[gaps.size()], film.grid));
    auto gap = share_gap(film, tissue_->walls[gaps.size()], gap_keys.back());
    if (!gap.ok()) return gap.status();
    gaps.emplace_back(*std::move(gap));
    for (int cell = 0; cell < film.grid.n_cells(); ++cell) cell_of_tissue_.push_back(offset + cell);
  }
  std::vector<film::FilmProjection*> films;
  for (const auto& projection : projections_) films.push_back(projection.get());
  film_solver_ = std::make_unique<coupling::FilmSolver>(std::move(films));
  if (tissue_) {
    if (tissue_->tissue.n_dofs() == 0)
      return field_violation("model", "holds every node of its tissue: nothing can move");
    const Eigen::Matrix3Xd& rest = tissue_->tissue.mesh().rest_positions;
    const double extent = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
    least_force_ = kLeastForceShare * tissue_->tissue.system_matrix().diagonal().norm() * extent;
    gaps_ = std::make_unique<coupling::GapSystem>(std::move(gaps), tissue_->tissue.n_dofs());
    if (const absl::Status status = analyse(gap_keys); !status.ok()) return status;
    const absl::Status status = check_every_cell_can_open();
    if (!status.ok()) return status;
  }
  rest_volume_.resize(cell_offset_.back());
  mechanics::SimulationState rest;
  if (tissue_) rest.positions = tissue_->tissue.mesh().rest_positions;
  for (size_t f = 0; f < films_.size(); ++f) {
    const plan::FilmLayout& film = films_[f];
    if (gap_of_film_[f] < 0) {
      rest_metric_.push_back(
          film::compute_film_metric(film.grid, plan::vertices_on_skin(model_.geometry.grid, film.grid)));
    } else {
      rest_metric_.push_back(
          film::compute_film_metric(film.grid, gaps_->film(gap_of_film_[f]).mid_surface(rest.positions)));
    }
    rest_area_.push_back(rest_metric_[f].area);
    for (int cell = 0; cell < film.grid.n_cells(); ++cell) {
      const geometry::ChartPoint centre = film.cell_centre(cell);
      rest_volume_[cell_offset_[f] + cell] = rest_area_[f][cell] * film.rest_thickness.at(centre.xi, centre.eta);
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const coupling::GapGeometry>> CoupledStep::share_gap(const plan::FilmLayout& film,
                                                                                    const coupling::WallNodes& walls,
                                                                                    const std::string& key) {
  return model_.shared->gaps.get(key, [&]() -> absl::StatusOr<std::shared_ptr<const coupling::GapGeometry>> {
    return std::make_shared<const coupling::GapGeometry>(coupling::make_gap_geometry(
        model_.geometry.grid, walls, film.grid, tissue_->tissue.dof_of_component(), tissue_->tissue.n_dofs()));
  });
}

/// With the pressures in the factorisation, where there are few enough.
absl::Status CoupledStep::analyse(const std::vector<std::string>& gap_keys) {
  const Eigen::SparseMatrix<double>& s = tissue_->tissue.system_matrix();
  const Eigen::SparseMatrix<double>& b = gaps_->derivative();
  const bool is_dense = b.rows() <= kMaxDenseCells;
  auto analysis = model_.shared->analyses.get(model::key_of_analysis(tissue_->key, gap_keys, is_dense), [&] {
    return coupling::FactorAnalysis::create(s, is_dense ? b : Eigen::SparseMatrix<double>(0, b.cols()));
  });
  if (!analysis.ok()) return field_violation("model", std::string(analysis.status().message()));
  const double bytes = static_cast<double>((*analysis)->n_values()) * sizeof(float);
  if (bytes > kMaxFactorBytes) {
    return field_violation(
        "model", absl::StrCat("needs ", bytes / kGibibyte, " GiB to factor with these films, must be at most ",
                              kMaxFactorBytes / kGibibyte, " GiB: take fewer hexahedra"));
  }
  factor_ = std::make_unique<coupling::CoupledFactor>(*std::move(analysis));
  has_lagged_mobility_ = is_dense && coupling_ == plan::CouplingMode::kExact &&
                         cell_offset_.back() > coupling::PressureSolver::kMaxDirectCells;
  return absl::OkStatus();
}

uint64_t CoupledStep::memory_bytes() const {
  const auto n_cells = static_cast<uint64_t>(cell_offset_.back());
  if (factor_ == nullptr) return n_cells * kBytesACell;
  const uint64_t n_gap_cells = static_cast<uint64_t>(gaps_->derivative().rows());
  const uint64_t n_dense = n_gap_cells <= kMaxDenseCells ? n_gap_cells : 0;
  const auto n_values =
      static_cast<uint64_t>(tissue_->tissue.system_matrix().nonZeros() + gaps_->derivative().nonZeros());
  return kBytesAFactorValue * static_cast<uint64_t>(factor_->analysis().n_values()) +
         sizeof(double) * n_dense * n_dense + n_values * kBytesAValue + static_cast<uint64_t>(n_dofs()) * kBytesADof +
         n_cells * kBytesACell;
}

absl::Status CoupledStep::check_every_cell_can_open() {
  gaps_->evaluate(tissue_->tissue.mesh().rest_positions);
  Eigen::VectorXd opening = Eigen::VectorXd::Zero(gaps_->volume().size());
  const Eigen::SparseMatrix<double>& b = gaps_->derivative();
  for (int column = 0; column < b.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(b, column); it; ++it) opening[it.row()] += std::abs(it.value());
  }
  for (size_t f = 0; f < films_.size(); ++f) {
    for (int cell = 0; gap_of_film_[f] >= 0 && cell < films_[f].grid.n_cells(); ++cell) {
      const auto row = std::lower_bound(cell_of_tissue_.begin(), cell_of_tissue_.end(), cell_offset_[f] + cell) -
                       cell_of_tissue_.begin();
      if (opening[row] > 0.0) continue;
      const geometry::ChartPoint at = films_[f].cell_centre(cell);
      return field_violation(
          absl::StrCat("films[", f, "].zones[", films_[f].grid.zone_of_cell[cell], "]"),
          absl::StrCat("has a film cell at (", at.xi, ", ", at.eta,
                       ") of the chart where no node of the tissue is free: make the zone at least two cells wide"));
    }
  }
  return absl::OkStatus();
}

mechanics::SimulationState CoupledStep::rest_state() const {
  mechanics::SimulationState state;
  if (tissue_) {
    state.positions = tissue_->tissue.mesh().rest_positions;
    state.velocities.setZero(3, state.positions.cols());
    for (Eigen::Matrix3Xd& earlier : state.earlier_velocities) earlier = state.velocities;
    state.spring_is_intact.setOnes(n_ligament_springs());
    state.factored_positions = state.positions;
    state.factored_springs = state.spring_is_intact;
  }
  for (size_t f = 0; f < films_.size(); ++f) {
    const film::FilmGrid& grid = films_[f].grid;
    mechanics::FilmState film;
    film.volume = rest_volume_.segment(cell_offset_[f], grid.n_cells());
    film.pressure.setZero(grid.n_cells());
    film.velocity.setZero(grid.n_edges());
    film.volume_rate.setZero(grid.n_cells());
    film.pressure_rate.setZero(grid.n_cells());
    film.earlier_volume_rate.setZero(grid.n_cells());
    film.earlier_pressure_rate.setZero(grid.n_cells());
    if (has_lagged_mobility_) film.factored_mobility.setZero(projections_[f]->pattern().nonZeros());
    if (fat_.is_elastic()) film.wall_stress.setZero(grid.n_edges());
    if (films_[f].connective_tissue.entry_pressure > 0.0) film.is_entered.setZero(grid.n_cells());
    state.films.push_back(std::move(film));
  }
  return state;
}

}  // namespace lipofill::step
