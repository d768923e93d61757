#pragma once

namespace lipofill::coupling {

/// Holds OpenBLAS and CHOLMOD to the calling thread: sessions are the project's parallelism, one thread each. To be
/// called on every thread that uses them. Decision record: core/doc/decisions/001-openblas-with-locks.md.
void keep_algebra_on_this_thread();

}  // namespace lipofill::coupling
