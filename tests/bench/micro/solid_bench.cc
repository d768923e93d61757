// Element work of the tissue: what a step does for every hexahedron.

#include <benchmark/benchmark.h>

#include "core/solid/geometric_stiffness.h"
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

/// The stiffness of tension alone, which is a part of the assembly.
void geometric_stiffness(benchmark::State& state) {
  MicroCase& micro = micro_case(state.range(0));
  const solid::HexMesh& mesh = micro.parts->tissue().mesh();
  std::vector<solid::ElasticMaterial> materials;
  for (const auto& layer : micro.jaw.model->layers) materials.push_back(layer.material);
  const std::vector<std::array<bool, 3>> all_free(mesh.n_nodes(), {false, false, false});
  const solid::SystemPattern pattern(mesh.n_nodes(), mesh.hexahedra, all_free);
  const solid::GeometricStiffness stiffness(mesh, materials, pattern);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(pattern.matrix().nonZeros() + 1);
  for (auto _ : state) stiffness.add(micro.parts->positions(), values);
  count_hexahedra(state, micro);
}

BENCHMARK(element_force)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(element_assembly)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);
BENCHMARK(geometric_stiffness)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lipofill::bench
