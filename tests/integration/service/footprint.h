#pragma once

#include <sys/types.h>

namespace lipofill::testing {

/// What the kernel tells of a process: /proc/PID.
struct Footprint {
  int threads = 0;
  int sockets = 0;
  double resident_mb = 0.0;  ///< 1 MB: 10^6 bytes
};

Footprint read_footprint(pid_t process);

}  // namespace lipofill::testing
