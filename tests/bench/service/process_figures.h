#pragma once

#include <sys/types.h>

#include <map>
#include <string>

namespace lipofill::bench {

/// What the kernel tells of a process: /proc/PID.
struct ProcessFigures {
  double cpu_s = 0.0;                          ///< all threads took it, ended ones too
  double resident_mb = 0.0;                    ///< 1 MB: 10^6 bytes
  int threads = 0;                             ///< alive
  std::map<std::string, double> cpu_s_of;      ///< what threads alive took, by their name without its number
  std::map<std::string, int> threads_of_name;  ///< the same

  /// CPU seconds of the threads of that name, 0 where there is none.
  double cpu_s_of_name(const std::string& name) const;
};

/// Figures of a process as they are now; all 0 for one that is not there.
ProcessFigures read_process(pid_t process);

/// CPU time of the calling process and of the calling thread [s].
double process_cpu_s();
double thread_cpu_s();

}  // namespace lipofill::bench
