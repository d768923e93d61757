#pragma once

#include <string>

namespace lipofill::coupling {

/// Pins OpenBLAS and CHOLMOD to the calling thread: sessions are the project's parallelism, one
/// thread each. Every thread that uses them calls this first. Decision record:
/// core/doc/decisions/001-openblas-with-locks.md.
void pin_algebra_to_this_thread();

/// Returns the family of OpenBLAS kernels that this process computes with, for example "Haswell".
///
/// Programs pin it before main() begins, whatever the processor and whatever OPENBLAS_CORETYPE
/// says: OpenBLAS picks kernels by processor, and each family rounds in its own way, so that the
/// same plan would end in other bytes on another machine. On a processor without AVX2 and FMA
/// OpenBLAS's own choice stays.
/// Decision record: core/doc/decisions/019-pinned-kernels.md. Checked by
/// tests/integration/faces/pinned_results_test.cc.
std::string algebra_kernels();

/// True when that family is the pinned one, so that results are those of every other machine.
bool has_pinned_kernels();

}  // namespace lipofill::coupling
