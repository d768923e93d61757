// The coupled solve: factor, solves with it, the films' pressure.

#include <benchmark/benchmark.h>

#include "core/coupling/coupled_factor.h"
#include "core/coupling/film_solve.h"
#include "tests/bench/micro/micro_case.h"

namespace lipofill::bench {
namespace {

using coupling::CoupledFactor;
using coupling::Precision;

std::shared_ptr<const coupling::FactorAnalysis> analyse(const MicroCase& micro) {
  return coupling::FactorAnalysis::create(micro.step.s, micro.step.b).value();
}

void count_unknowns(benchmark::State& state, const MicroCase& micro) {
  state.SetItemsProcessed(state.iterations() * (micro.step.n_dofs() + micro.step.n_cells()));
}

/// Orders and analyses the pattern; once a model.
void factor_analysis(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(analyse(micro));
  count_unknowns(state, micro);
}

void factor(benchmark::State& state, Precision precision) {
  MicroCase& micro = micro_case(state.range(0));
  CoupledFactor factor(analyse(micro));
  for (auto _ : state) {
    if (!factor.factorise(micro.step.s, micro.step.b, precision)) state.SkipWithError("not positive definite");
  }
  count_unknowns(state, micro);
  state.counters["flops"] =
      benchmark::Counter(factor.analysis().operations(), benchmark::Counter::kIsIterationInvariantRate);
}

/// The gap's response to a force, and the displacement by a pressure.
void solve(benchmark::State& state, Precision precision) {
  MicroCase& micro = micro_case(state.range(0));
  CoupledFactor factor(analyse(micro));
  if (!factor.factorise(micro.step.s, micro.step.b, precision)) state.SkipWithError("not positive definite");
  Eigen::VectorXd response, dx;
  for (auto _ : state) {
    factor.solve_gap_response(micro.step.f, response);
    factor.solve_displacement(micro.parts->pressure(), dx);
  }
  count_unknowns(state, micro);
  const int64_t bytes_of_a_value = precision == Precision::kSingle ? sizeof(float) : sizeof(double);
  state.SetBytesProcessed(2 * state.iterations() * factor.analysis().n_values() * bytes_of_a_value);
}

/// Thickness and pressure of the fat after a step, from those before it, over tissue that gives
/// way.
void film_solve(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  CoupledFactor factor(analyse(micro));
  if (!factor.factorise(micro.step.s, micro.step.b, Precision::kSingle)) state.SkipWithError("not positive definite");
  coupling::FilmSolver solver({&micro.parts->projection()});
  coupling::WallCompliance walls;
  walls.dense = &factor.compliance();
  solver.pressure_solver().set_walls(walls);
  coupling::FilmSolution before;
  before.volume = micro.parts->projection().input().volume;
  before.pressure = micro.parts->pressure();
  before.flux = {-film::compute_edge_difference(micro.parts->projection().grid(), before.pressure)};
  if (solver.pressure_solver().is_lagged()) {
    std::vector<Eigen::VectorXd> mobility;
    solver.measure_mobility(before, mobility);
    solver.pressure_solver().renew_preconditioner(mobility);
  }
  const Eigen::VectorXd gap = before.volume - factor.compliance() * before.pressure;
  for (auto _ : state) {
    coupling::FilmSolution after = before;
    solver.solve(gap, {}, {}, after);
    if (!after.converged) state.SkipWithError("the film did not converge");
  }
  state.SetItemsProcessed(state.iterations() * micro.step.n_cells());
}

BENCHMARK(factor_analysis)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(factor, single, Precision::kSingle)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(factor, double, Precision::kDouble)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve, single, Precision::kSingle)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve, double, Precision::kDouble)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(film_solve)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lipofill::bench
