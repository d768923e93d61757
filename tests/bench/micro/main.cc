// lipofill_microbench: the parts of a step one by one, at 1, 4 and 16 times the paper's size; items
// are hexahedra, film cells, triangles or frames. Options are those of Google Benchmark.

#include <benchmark/benchmark.h>
#include <omp.h>

extern "C" void openblas_set_num_threads(int n_threads);

int main(int argc, char** argv) {
  openblas_set_num_threads(1);
  omp_set_max_active_levels(0);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
