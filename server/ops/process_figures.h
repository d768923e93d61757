#pragma once

#include "server/ops/metrics.h"

namespace lipofill::server {

/// Memory, processor time, threads and files of this process as of now, from /proc; 0 where there
/// is none.
struct ProcessFigures {
  double resident_bytes = 0.0;
  double cpu_s = 0.0;
  double threads = 0.0;
  double open_files = 0.0;
};
ProcessFigures read_process_figures();

/// Adds them, the program's version and the time of its start, under the names that other programs
/// use too: process_resident_memory_bytes, process_cpu_seconds_total, process_threads,
/// process_open_fds, process_start_time_seconds, lipofill_build_info{version}.
void add_process_metrics(Metrics& metrics);

}  // namespace lipofill::server
