#include "tests/bench/linear_step.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lipofill::bench {
namespace {

constexpr double kMetresPerMillimetre = 1e-3;

/// The values of a frame's field; those of a film's cells or of the tissue's nodes come in the
/// order of the model.
Eigen::VectorXd field_values(const std::vector<simulation::FrameField>& fields, const std::string& name, double unit) {
  const auto field = std::find_if(fields.begin(), fields.end(), [&name](const auto& f) { return f.name == name; });
  return unit * Eigen::Map<const Eigen::VectorXf>(field->values.data(), static_cast<Eigen::Index>(field->values.size()))
                    .cast<double>();
}

film::Fat make_fat(const plan::SimulationSpec& spec) {
  film::Fat fat;
  fat.viscosity = spec.fat_viscosity;
  fat.density = spec.fat_density;
  return fat;
}

}  // namespace

absl::StatusOr<std::unique_ptr<StepParts>> StepParts::create(const JawAngle& jaw) {
  std::unique_ptr<StepParts> parts(new StepParts(jaw));
  auto film = plan::place_film(*jaw.model, jaw.spec.films[0]);
  if (!film.ok()) return film.status();
  parts->films_.push_back(*std::move(film));
  auto tissue = mechanics::set_up_tissue(*jaw.model, parts->films_, jaw.spec);
  if (!tissue.ok()) return tissue.status();
  parts->tissue_ = std::make_unique<mechanics::TissueSetup>(*std::move(tissue));
  const solid::Tissue& solid = parts->tissue_->tissue;
  const film::FilmGrid& grid = parts->films_[0].grid;
  std::vector<coupling::GapVolume> gaps;
  gaps.emplace_back(jaw.model->geometry.grid, parts->tissue_->walls[0], grid, solid.dof_of_component(), solid.n_dofs());
  parts->gaps_ = std::make_unique<coupling::GapSystem>(std::move(gaps), solid.n_dofs());
  parts->projection_ = std::make_unique<film::FilmProjection>(grid);
  parts->rest_metric_ = film::compute_film_metric(grid, parts->gaps_->film(0).mid_surface(solid.mesh().rest_positions));
  return parts;
}

void StepParts::move_to(const simulation::Simulation& simulation) {
  const Eigen::VectorXd displacement = field_values(simulation.frame({"tissue"}), "displacement", kMetresPerMillimetre);
  positions_ = tissue_->tissue.mesh().rest_positions + displacement.reshaped(3, displacement.size() / 3);
  const auto film = simulation.frame({"film/" + films_[0].name});
  thickness_ = field_values(film, "thickness", kMetresPerMillimetre);
  pressure_ = field_values(film, "pressure", 1.0);
}

void StepParts::assemble() {
  tissue_->tissue.assemble(positions_, jaw_.spec.step);
  gaps_->evaluate(positions_);
}

void StepParts::move_to_wave() {
  constexpr double kWaveLength = 0.03, kHeight = 1e-3, kThickness = 1e-3;  // m
  constexpr double kPressure = 500.0;                                      // Pa
  const auto wave = [](const Eigen::Vector3d& x) { return std::sin(x.sum() * 2.0 * std::numbers::pi / kWaveLength); };
  positions_ = tissue_->tissue.mesh().rest_positions;
  for (auto x : positions_.colwise()) x += kHeight * wave(x) * Eigen::Vector3d::Ones();
  const film::FilmMetric metric =
      film::compute_film_metric(films_[0].grid, gaps_->film(0).mid_surface(tissue_->tissue.mesh().rest_positions));
  thickness_.resize(metric.area.size());
  for (Eigen::Index cell = 0; cell < thickness_.size(); ++cell) {
    thickness_[cell] = kThickness * (1.0 + 0.5 * wave(metric.centre.col(cell)));
  }
  pressure_ = (kPressure / kThickness) * thickness_;
}

void StepParts::begin_film_step() {
  const film::FilmGrid& grid = films_[0].grid;
  metric_ = film::compute_film_metric(grid, gaps_->film(0).mid_surface(positions_));
  film::FilmStepInput input;
  input.metric = &metric_;
  input.fat = make_fat(jaw_.spec);
  input.volume = thickness_.cwiseProduct(metric_.area);
  input.injected.setZero(grid.n_cells());
  input.velocity.setZero(grid.n_edges());
  input.body_force.setZero(grid.n_edges());
  input.dt = jaw_.spec.step;
  projection_->begin_step(std::move(input));
  projection_->set_thickness(projection_->input().volume, -film::compute_edge_difference(grid, pressure_));
}

LinearStep StepParts::linear_step() {
  assemble();
  begin_film_step();
  LinearStep step;
  step.s = tissue_->tissue.system_matrix();
  step.b = gaps_->derivative();
  step.j = projection_->linearise(pressure_);
  step.f = -tissue_->tissue.internal_force();
  const Eigen::VectorXd no_pressure = Eigen::VectorXd::Zero(step.n_cells());
  const double rest_thickness = films_[0].rest_thickness.at(0.5, 0.5);
  step.d = projection_->compute_volume(projection_->compute_flux(no_pressure)) - rest_thickness * rest_metric_.area -
           gaps_->volume();
  return step;
}

double relative_difference(const LinearAnswer& answer, const LinearAnswer& reference) {
  return std::max((answer.pressure - reference.pressure).norm() / reference.pressure.norm(),
                  (answer.displacement - reference.displacement).norm() / reference.displacement.norm());
}

}  // namespace lipofill::bench
