// What a step does for every film cell, and where film and tissue meet.

#include <benchmark/benchmark.h>

#include "core/film/advection.h"
#include "core/film/edge_operators.h"
#include "core/film/edge_thickness.h"
#include "core/film/viscosity.h"
#include "tests/bench/micro/micro_case.h"

namespace lipofill::bench {
namespace {

void count_cells(benchmark::State& state, const MicroCase& micro) {
  state.SetItemsProcessed(state.iterations() * micro.step.n_cells());
}

Eigen::VectorXd volume_of(MicroCase& micro) {
  return micro.parts->projection().input().volume;
}

/// A flow of about a centimetre a second, along the pressure's fall.
Eigen::VectorXd velocity_of(MicroCase& micro) {
  const Eigen::VectorXd fall =
      -film::compute_edge_difference(micro.parts->projection().grid(), micro.parts->pressure());
  return fall * (1e-5 / fall.cwiseAbs().maxCoeff());
}

/// Mobility from the thickness and J from that.
void film_assembly(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  film::FilmProjection& projection = micro.parts->projection();
  const Eigen::VectorXd volume = volume_of(micro), flux = velocity_of(micro);
  for (auto _ : state) {
    projection.set_thickness(volume, flux);
    benchmark::DoNotOptimize(projection.linearise(micro.parts->pressure()).valuePtr());
  }
  count_cells(state, micro);
}

void film_flux(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  film::FilmProjection& projection = micro.parts->projection();
  for (auto _ : state) {
    const Eigen::VectorXd flux = projection.compute_flux(micro.parts->pressure());
    benchmark::DoNotOptimize(projection.compute_volume(flux).data());
  }
  count_cells(state, micro);
}

void film_advection(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  const Eigen::VectorXd velocity = velocity_of(micro);
  film::Advection advection(micro.parts->projection().grid());
  Eigen::VectorXd next;
  for (auto _ : state) advection.advance(micro.parts->metric(), velocity, micro.jaw.spec.step, next);
  count_cells(state, micro);
}

void film_viscosity(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  const film::FilmProjection& projection = micro.parts->projection();
  const film::FilmGrid& grid = projection.grid();
  const Eigen::VectorXd velocity = velocity_of(micro);
  const Eigen::VectorXd edge_thickness = film::compute_edge_thickness(grid, micro.parts->thickness(), velocity);
  film::ImplicitViscosity viscosity(grid);
  Eigen::VectorXd next;
  for (auto _ : state) {
    viscosity.advance(grid, micro.parts->metric(), projection.input().fat, micro.parts->thickness(), edge_thickness,
                      velocity, micro.jaw.spec.step, next);
  }
  count_cells(state, micro);
}

void film_metric(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  const film::FilmGrid& grid = micro.parts->projection().grid();
  for (auto _ : state) {
    const Eigen::Matrix3Xd vertices = micro.parts->gaps().film(0).mid_surface(micro.parts->positions());
    benchmark::DoNotOptimize(film::compute_film_metric(grid, vertices).area.data());
  }
  count_cells(state, micro);
}

/// g(x) and B.
void gap_volume(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  for (auto _ : state) micro.parts->gaps().evaluate(micro.parts->positions());
  count_cells(state, micro);
}

BENCHMARK(film_assembly)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(film_flux)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(film_advection)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(film_viscosity)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(film_metric)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(gap_volume)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lipofill::bench
