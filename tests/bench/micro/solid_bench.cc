// Element work of the tissue: what a step does for every hexahedron.

#include <benchmark/benchmark.h>

#include "core/solid/hex_quality.h"
#include "tests/bench/micro/micro_case.h"

namespace lipofill::bench {
namespace {

void count_hexahedra(benchmark::State& state, const MicroCase& micro) {
  state.SetItemsProcessed(state.iterations() * micro.simulation->n_hexahedra());
}

void element_force(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  for (auto _ : state) micro.parts->tissue().compute_force(micro.parts->positions());
  count_hexahedra(state, micro);
}

void element_assembly(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  for (auto _ : state) micro.parts->tissue().assemble(micro.parts->positions(), micro.jaw.spec.step);
  count_hexahedra(state, micro);
}

/// The least scaled Jacobian, which every iteration looks at.
void element_quality(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        solid::compute_min_scaled_jacobian(micro.parts->tissue().mesh(), micro.parts->positions()));
  }
  count_hexahedra(state, micro);
}

BENCHMARK(element_force)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(element_assembly)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(element_quality)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lipofill::bench
